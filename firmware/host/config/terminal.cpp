// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/terminal.hpp"

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

}  // namespace fovea::config
