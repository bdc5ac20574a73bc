// SPDX-License-Identifier: Apache-2.0
// A fault of a run, for its summary.
#pragma once

#include <fmt/format.h>

#include <string>

#include "firmware/host/run/in_words.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::run {

struct FaultEvent {
  double t_s = 0.0;  // since the run's first tick
  hal::Fault fault = hal::Fault::kNone;
  int joint = -1;  // at fault, from 0; -1: none
};

// "joint 4"; "" if no single joint is at fault.
inline std::string JointOf(const FaultEvent& event) {
  return event.joint >= 0 ? fmt::format("joint {}", event.joint + 1) : std::string();
}

// E.g. "a sensor value was not finite (non_finite_sensor), at 1.005 s, joint 1; see safety.non_finite_ticks".
inline std::string InWords(const FaultEvent& event) {
  const std::string joint = JointOf(event);
  const std::string key = hal::Key(event.fault);
  return fmt::format("{}, at {:.3f} s{}{}", InWords(event.fault), event.t_s,
                     joint.empty() ? "" : ", " + joint, key.empty() ? "" : "; see " + key);
}

}  // namespace fovea::run
