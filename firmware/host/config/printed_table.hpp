// SPDX-License-Identifier: Apache-2.0
// The results of a program as rows of name and value, for a person.
#pragma once

#include <cstddef>
#include <string>

#include "firmware/host/config/terminal.hpp"

namespace fovea::config {

class PrintedTable {
 public:
  static constexpr std::size_t kNameWidth = 24;  // behind an indent of two

  explicit PrintedTable(const TextStyle& style, std::size_t name_width = kNameWidth)
      : style_(style), name_width_(name_width) {}

  // Adds a row. A long value breaks between words; its next lines begin at the value's column.
  void Row(const std::string& name, const std::string& value, Paint paint = Paint::kPlain);
  // The same for a value that is copied, such as a path: its line is never broken.
  void WholeRow(const std::string& name, const std::string& value);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  const TextStyle style_;
  const std::size_t name_width_;
  std::string text_;
};

}  // namespace fovea::config
