// Everything that the servo watches, as a table for people: limits, which shape the motion, and faults, which
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

// All of them, with the key that sets each and its default.
std::string GuardTableAsMarkdown();

}  // namespace fovea::config
