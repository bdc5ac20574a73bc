// SPDX-License-Identifier: Apache-2.0
// A joint's acceleration, jerk and braking, within its shares of the arm's limits.
#pragma once

#include <algorithm>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::trajectory {

struct JointPace {
  double ddq_max = 0.0;       // [rad/s^2]
  double dddq_max = 0.0;      // [rad/s^3]
  double ramp_s = 0.0;        // time from no acceleration to ddq_max
  double deceleration = 0.0;  // for stopping before a barrier [rad/s^2]
  double reaction_s = 0.0;    // until it acts: a tick to see, a tick to act, and the ramp
};

// Of joint `i`. Real-time: yes.
[[nodiscard]] inline JointPace PaceOf(const config::ServoConfig& config, int i) noexcept {
  const config::GuardConfig& guard = config.guard;
  const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
  JointPace pace;
  pace.dddq_max = guard.joint_jerk_fraction * joint.dddq_max;
  pace.ddq_max = guard.joint_acceleration_fraction * joint.ddq_max;
  pace.ramp_s = pace.ddq_max / pace.dddq_max;
  pace.deceleration = guard.braking_fraction * pace.ddq_max;
  pace.reaction_s = 2.0 * hal::kTickPeriodS + pace.deceleration / pace.dddq_max;
  return pace;
}

// The longest reaction over the joints: the arm as a whole brakes no sooner [s]. Real-time: yes.
[[nodiscard]] inline double SlowestReaction(const config::ServoConfig& config) noexcept {
  double slowest = 0.0;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    slowest = std::max(slowest, PaceOf(config, i).reaction_s);
  }
  return slowest;
}

}  // namespace fovea::trajectory
