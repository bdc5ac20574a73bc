// SPDX-License-Identifier: Apache-2.0
// Formats the text of --help for a terminal: lines that fit its width, headings in bold.
#pragma once

#include <cstddef>
#include <string>

#include "firmware/host/config/terminal.hpp"

namespace fovea::config {

// Breaks each line of `text` between words so that it fits into `width`. A number stays with its unit. A
// longer word breaks after a comma, or stays whole if it has none. The rest of a line begins at `column`.
// Every line ends with a line end.
std::string Fitted(const std::string& text, std::size_t column, std::size_t width);

// As Fitted, for a help text: the rest of a line is indented to the column of its description, or by two more
// than an indented line. Headings are bold if the style has colours.
std::string FormatHelp(const std::string& text, const TextStyle& style);

}  // namespace fovea::config
