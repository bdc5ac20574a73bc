// SPDX-License-Identifier: Apache-2.0
// Stage 5, clamp: the last step before the arm, in every mode. Makes torques finite, in range and in rate.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

struct ClampResult {
  bool finite = true;  // false: `tau` held a value that is not finite; it was replaced, see below
  hal::LimitSet limits = 0;
};

// Limits `tau` [num_joints] to one tick of the rate limit around `tau_applied`, the command that the arm
// reports as in force, and to the range of the joints. Replaces a non-finite entry by the applied torque,
// faded towards zero at the rate limit. Real-time: yes.
[[nodiscard]] ClampResult ClampTorque(const model::ArmModel& arm, const config::SafetyConfig& config,
                                      const model::VecN& tau_applied, model::VecN& tau) noexcept;

}  // namespace fovea::guard
