// SPDX-License-Identifier: Apache-2.0
// How printed text looks: its width and its colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace fovea::config {

inline constexpr std::size_t kMostWidth = 100;               // of a line, in characters, for a person
inline constexpr std::size_t kUnbroken = std::string::npos;  // width of output that programs read
inline constexpr std::size_t kContinued = 2;                 // indent of the rest of a line that is too long

struct TextStyle {
  std::size_t width = kMostWidth;
  bool colour = false;  // colours and bold headings
};

enum class Paint : std::uint8_t { kPlain, kBold, kGood, kBad };

// Whether output has colours: on a terminal, unless NO_COLOR is set or TERM is dumb. Both variables may be
// null: not set.
bool ColourFor(bool is_terminal, const char* no_color, const char* term);

// Width of a line. On a terminal: its `columns`, limited to 60 to kMostWidth; kMostWidth if they are unknown
// (0). Otherwise kUnbroken: a file or a pipe gets each line whole.
std::size_t WidthFor(bool is_terminal, std::size_t columns);

// The same for an open file, e.g. standard output.
bool UsesColour(int fd);
std::size_t TerminalWidth(int fd);
TextStyle StyleOf(int fd);

// `text` with the terminal codes of `paint` around it; `text` itself if `style` has no colours.
std::string Painted(const std::string& text, Paint paint, const TextStyle& style);

// `text` as it can be shown: each byte of a control character or of invalid UTF-8 as "\x1b". For names of
// files, which may contain any bytes.
std::string Printable(std::string_view text);

}  // namespace fovea::config
