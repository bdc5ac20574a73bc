// SPDX-License-Identifier: Apache-2.0
// Checks that the motors can follow every reference that the guard allows.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::guard {

struct MotorNeed {
  int joint = -1;        // from 0
  double torque = 0.0;   // for its largest acceleration, at the ready posture with the load [Nm, N]
  double allowed = 0.0;  // of its motor [Nm, N]
};

// Of the joint with the smallest reserve: M_ii ddq_max to tau_max, each with its share. Not for the tick.
[[nodiscard]] MotorNeed LargestMotorNeed(const config::ServoConfig& config) noexcept;

}  // namespace fovea::guard
