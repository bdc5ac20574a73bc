// SPDX-License-Identifier: Apache-2.0
// The results of a program as rows of name and value, for a person.
#pragma once

#include <string>

#include "firmware/host/config/terminal.hpp"

namespace fovea::config {

class PrintedTable {
 public:
  explicit PrintedTable(const TextStyle& style) : style_(style) {}

  // Adds a row. A long value breaks between words; its next lines begin at the value's column. The values of
  // all tables begin at the same column, behind the longest usual name; a longer name moves its own value.
  void Row(const std::string& name, const std::string& value, Paint paint = Paint::kPlain);
  // The same for a value that is copied, such as a path: its line is never broken.
  void WholeRow(const std::string& name, const std::string& value);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  const TextStyle style_;
  std::string text_;
};

}  // namespace fovea::config
