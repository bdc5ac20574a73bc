// SPDX-License-Identifier: Apache-2.0
// Reasons for a person.
#pragma once

#include <fmt/format.h>

#include <string>

#include "fovea/hal/events.hpp"

namespace fovea::run {

// E.g. "the target was lost (target_lost)": the words, and the name that logs and documents use. `Reason` is
// a hal::HoldReason, hal::Fault or hal::Intake.
template <typename Reason>
std::string InWords(Reason reason) {
  return fmt::format("{} ({})", hal::Words(reason), hal::Name(reason));
}

}  // namespace fovea::run
