// Stage 5, clamp: the last word before the arm, in every mode. Finite, within range, within rate.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

struct ClampResult {
  bool finite = true;  // false: `tau` held a value that is not finite; it was replaced, see below
  hal::LimitSet limits = 0;
};

// Brings `tau` [num_joints] within reach of `tau_applied`, the command that the arm says is in force, by
// one tick of the rate limit, and into the range of the joints. A non-finite entry is replaced by the applied
// torque, faded towards zero at the rate limit. Real-time: yes.
[[nodiscard]] ClampResult ClampTorque(const model::ArmModel& arm, const config::SafetyConfig& config,
                                      const model::VecN& tau_applied, model::VecN& tau) noexcept;

}  // namespace fovea::guard
