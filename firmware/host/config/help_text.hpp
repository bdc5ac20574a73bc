// The text of --help as a terminal shows it: lines that fit, headings that stand out.
#pragma once

#include <cstddef>
#include <string>

namespace fovea::config {

struct HelpStyle {
  std::size_t width = 100;  // of a line, in characters
  bool bold_headings = false;
};

// For what standard output is: as wide as the terminal, from 60 to 100 characters, and headings in bold
// unless the environment's NO_COLOR is set; 100 characters and plain text where it is no terminal.
HelpStyle HelpStyleOfOutput();

// `text` with each line broken between words so that it fits into style.width; a word that is longer is
// broken behind commas, and stays whole where it has none. What follows a break is indented to the column of
// its description, or by two more than its line.
std::string FormatHelp(const std::string& text, const HelpStyle& style);

}  // namespace fovea::config
