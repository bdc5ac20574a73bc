// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/help_text.hpp"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace fovea::config {
namespace {

constexpr std::size_t kDescriptionColumn = 30;  // where CLI11 starts the text of options and subcommands

// The column at which the rest of a line that is too long begins.
std::size_t RestColumn(const std::string& line) {
  const std::size_t first = line.find_first_not_of(' ');
  const bool is_described = first > 0 && line.size() > kDescriptionColumn &&
                            line[kDescriptionColumn - 1] == ' ' && line[kDescriptionColumn] != ' ';
  if (first >= kDescriptionColumn || is_described) {
    return kDescriptionColumn;
  }
  return first == 0 ? 0 : first + 2;
}

bool IsHeading(const std::string& line) {
  return line.size() > 1 && std::isupper(static_cast<unsigned char>(line.front())) != 0 &&
         line.back() == ':' && line.find(". ") == std::string::npos;
}

void AppendLine(std::string line, std::size_t column, std::size_t width, std::string& text) {
  while (line.size() > width) {
    std::size_t space = line.rfind(' ', width);
    if (space != std::string::npos && space > 0 && line[space + 1] == '%') {
      space = line.rfind(' ', space - 1);  // a number stays with its %
    }
    if (space == std::string::npos || space <= column) {
      // A word longer than the line, such as a list of choices, breaks after a comma.
      if (const std::size_t comma = line.rfind(',', width - 1);
          comma != std::string::npos && comma > column) {
        text.append(line, 0, comma + 1).append("\n");
        line = std::string(column, ' ') + line.substr(comma + 1);
        continue;
      }
      space = line.find(' ', std::max(width, column + 1));
    }
    if (space == std::string::npos) {
      break;
    }
    text.append(line, 0, space).append("\n");
    const std::size_t next = line.find_first_not_of(' ', space);
    line = next == std::string::npos ? std::string() : std::string(column, ' ') + line.substr(next);
  }
  text.append(line).append("\n");
}

}  // namespace

std::string Fitted(const std::string& text, std::size_t column, std::size_t width) {
  std::string fitted;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    AppendLine(line, column, width, fitted);
  }
  return fitted;
}

std::string FormatHelp(const std::string& text, const TextStyle& style) {
  std::string formatted;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (style.colour && IsHeading(line)) {
      formatted.append(Painted(line, Paint::kBold, style)).append("\n");
    } else {
      AppendLine(line, RestColumn(line), style.width, formatted);
    }
  }
  return formatted;
}

}  // namespace fovea::config
