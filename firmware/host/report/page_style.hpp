// SPDX-License-Identifier: Apache-2.0
// The common style of all pages: the report's style sheets.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace fovea::report {

// The text of the style sheets in `folder`, the folder of the report's page, for use inside another page.
// std::runtime_error, naming the file, when one cannot be read.
inline std::string PageStyle(const std::filesystem::path& folder) {
  std::string style;
  for (const char* part :
       {"page.css", "figures.css", "plots.css", "parts.css", "time.css", "config.css", "paper.css"}) {
    const std::filesystem::path file = folder / "style" / part;
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    if (text.str().empty()) {
      throw std::runtime_error(file.string() + ": cannot be read");
    }
    style += text.str();
  }
  return style;
}

}  // namespace fovea::report
