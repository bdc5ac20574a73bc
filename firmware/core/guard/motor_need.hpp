// Whether the motors can do what the guard allows the reference: the arm follows it no further than that.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::guard {

struct MotorNeed {
  int joint = -1;        // from 0
  double torque = 0.0;   // that its largest acceleration takes, at the ready posture with the load [Nm, N]
  double allowed = 0.0;  // that its motor may give [Nm, N]
};

// Of the joint that has least to spare: M_ii ddq_max against tau_max, each by its share. Not for the tick.
[[nodiscard]] MotorNeed LargestMotorNeed(const config::ServoConfig& config) noexcept;

}  // namespace fovea::guard
