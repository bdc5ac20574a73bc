// SPDX-License-Identifier: Apache-2.0
// Stage 0, inputs: accepts the arm's state, bridges a bad one for a configured time, or raises a fault.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/arm.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::task {

struct InputState {
  bool has_state = false;
  bool jumped = false;        // a velocity of this tick jumped and was not accepted
  std::int64_t stamp_ns = 0;  // of the last sound state
  std::uint64_t sequence = 0;
  int bad_ticks = 0;         // in a row without a new sound state
  int sound_ticks = 0;       // in a row with one
  int non_finite_ticks = 0;  // in a row with a joint value that is not finite
  int jumps = 0;             // twice the ticks with a velocity that jumps, less those without
  hal::JointArray q{};       // last finite values
  hal::JointArray dq{};
  hal::JointArray tau_applied{};
};

struct InputCheck {
  hal::Fault fault = hal::Fault::kNone;
  std::int32_t joint = -1;  // the joint at fault
};

// Checks and stores the arm's answer. `missed_ticks`: deadlines missed since the last tick. `velocity_share`:
// of a joint's velocity limit, above which it is too fast. Real-time: yes.
[[nodiscard]] InputCheck CheckInputs(const config::ServoConfig& config, const hal::Status& arm_status,
                                     const hal::ArmState& arm, std::int32_t missed_ticks,
                                     double velocity_share, InputState& state) noexcept;

}  // namespace fovea::task
