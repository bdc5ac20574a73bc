// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/help_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <string_view>

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

// Whether the space parts a number from its unit, as in "12.5 mm,".
bool IsBeforeUnit(const std::string& line, std::size_t space) {
  constexpr std::array<std::string_view, 26> kUnits{
      "%",  "px", "mm", "m",  "s",  "ms",  "us",  "ns",    "h",   "deg",   "rad", "Hz",    "kHz",
      "Nm", "N",  "kg", "KB", "MB", "KiB", "MiB", "rad/s", "m/s", "deg/s", "1/s", "times", "ticks"};
  if (space == 0 || std::isdigit(static_cast<unsigned char>(line[space - 1])) == 0) {
    return false;
  }
  std::string_view word = std::string_view(line).substr(space + 1);
  word = word.substr(0, word.find(' '));
  word = word.substr(0, word.find_last_not_of(",;:.)") + 1);
  return std::find(kUnits.begin(), kUnits.end(), word) != kUnits.end();
}

void AppendLine(std::string line, std::size_t column, std::size_t width, std::string& text) {
  while (line.size() > width) {
    std::size_t space = line.rfind(' ', width);
    if (space != std::string::npos && IsBeforeUnit(line, space)) {
      space = line.rfind(' ', space - 1);
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
