// SPDX-License-Identifier: Apache-2.0
// Everything that the servo watches, as a readable table: limits, which shape the motion, and faults, which
// stop it.
#pragma once

#include <string>

#include "fovea/hal/events.hpp"

namespace fovea::config {

struct GuardRow {
  const char* watches;
  const char* then;  // what happens
};
GuardRow RowOf(hal::Limit limit);
GuardRow RowOf(hal::Fault fault);

// All limits and faults, each with its key and the key's default.
std::string GuardTableAsMarkdown();

}  // namespace fovea::config
