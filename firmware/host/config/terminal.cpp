// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

namespace fovea::config {
namespace {

constexpr std::size_t kLeastWidth = 60;
constexpr std::array kPaintCodes{"", "\033[1m", "\033[32m", "\033[31m"};  // by Paint
constexpr const char* kEndOfPaint = "\033[0m";

// The number of bytes of the valid UTF-8 character at the start of `text`, 0 if there is none or if it is a
// control character.
std::size_t ShownBytes(std::string_view text) {
  const auto byte = [&text](std::size_t k) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k]));
  };
  const std::uint32_t first = byte(0);
  if (first < 0x80) {
    return first >= 0x20 && first != 0x7F ? 1 : 0;
  }
  const std::size_t size = first < 0xC0 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF8 ? 4 : 0;
  if (size == 0 || text.size() < size) {
    return 0;
  }
  std::uint32_t code = first & (0x7FU >> size);
  for (std::size_t k = 1; k < size; ++k) {
    if ((byte(k) & 0xC0U) != 0x80U) {
      return 0;
    }
    code = (code << 6U) | (byte(k) & 0x3FU);
  }
  // Least code of each size. 0x80 to 0x9F are control characters.
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0xA0, 0x800, 0x10000};
  const bool is_half = code >= 0xD800 && code <= 0xDFFF;  // of UTF-16
  return code >= kLeast[size] && code <= 0x10FFFF && !is_half ? size : 0;
}

}  // namespace

bool ColourFor(bool is_terminal, const char* no_color, const char* term) {
  return is_terminal && no_color == nullptr && (term == nullptr || std::string_view(term) != "dumb");
}

std::size_t WidthFor(bool is_terminal, std::size_t columns) {
  if (!is_terminal) {
    return kUnbroken;
  }
  return columns > 0 ? std::clamp(columns, kLeastWidth, kMostWidth) : kMostWidth;
}

bool UsesColour(int fd) { return ColourFor(isatty(fd) == 1, std::getenv("NO_COLOR"), std::getenv("TERM")); }

std::size_t TerminalWidth(int fd) {
  winsize size{};
  const bool is_known = ioctl(fd, TIOCGWINSZ, &size) == 0;
  return WidthFor(isatty(fd) == 1, is_known ? size.ws_col : 0);
}

TextStyle StyleOf(int fd) { return {TerminalWidth(fd), UsesColour(fd)}; }

std::string Painted(const std::string& text, Paint paint, const TextStyle& style) {
  return style.colour && paint != Paint::kPlain && !text.empty()
             ? kPaintCodes[static_cast<std::size_t>(paint)] + text + kEndOfPaint
             : text;
}

std::string Printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t bytes = ShownBytes(text);
    if (bytes > 0) {
      shown += text.substr(0, bytes);
    } else {
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    }
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return shown;
}

}  // namespace fovea::config
