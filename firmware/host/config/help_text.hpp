// Formats the text of --help for a terminal: lines that fit its width, headings in bold.
#pragma once

#include <cstddef>
#include <string>

namespace fovea::config {

struct HelpStyle {
  std::size_t width = 100;  // of a line, in characters
  bool bold_headings = false;
};

// The style for standard output. On a terminal: its width, limited to 60 to 100 characters, and bold headings
// unless the environment variable NO_COLOR is set. Otherwise: 100 characters and plain text.
HelpStyle HelpStyleOfOutput();

// Breaks each line of `text` between words so that it fits into style.width. A longer word breaks after a
// comma, or stays whole if it has none. The rest of a line is indented to the column of its description, or
// by two more than an indented line.
std::string FormatHelp(const std::string& text, const HelpStyle& style);

}  // namespace fovea::config
