// SPDX-License-Identifier: Apache-2.0
// Text in an HTML page.
#pragma once

#include <string>

namespace fovea::bench {

// `text` with the characters & < > " escaped for HTML.
inline std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

}  // namespace fovea::bench
