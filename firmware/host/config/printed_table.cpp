// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/printed_table.hpp"

#include <fmt/format.h>

#include "firmware/host/config/help_text.hpp"

namespace fovea::config {

void PrintedTable::Row(const std::string& name, const std::string& value, Paint paint) {
  const std::string head = fmt::format("  {:<{}}", name, name_width_);
  std::string lines = Fitted(head + value, head.size(), style_.width);
  lines.pop_back();  // its line end, which stays behind the paint
  text_ += lines.substr(0, head.size()) + Painted(lines.substr(head.size()), paint, style_) + "\n";
}

void PrintedTable::WholeRow(const std::string& name, const std::string& value) {
  text_ += fmt::format("  {:<{}}{}\n", name, name_width_, value);
}

}  // namespace fovea::config
