// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/printed_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "firmware/host/config/help_text.hpp"

namespace fovea::config {
namespace {

std::string HeadOf(const std::string& name) {
  const std::string head = fmt::format("  {:<24}", name);
  return head.back() == ' ' ? head : head + " ";
}

}  // namespace

void PrintedTable::Row(const std::string& name, const std::string& value, Paint paint) {
  const std::string head = HeadOf(name);
  std::istringstream lines(Fitted(head + value, head.size(), style_.width));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t column = std::min(head.size(), line.size());
    text_ += line.substr(0, column) + Painted(line.substr(column), paint, style_) + "\n";
  }
}

void PrintedTable::WholeRow(const std::string& name, const std::string& value) {
  text_ += HeadOf(name) + value + "\n";
}

}  // namespace fovea::config
