// SPDX-License-Identifier: Apache-2.0
// Roll, pitch, yaw: the form of an orientation in a configuration.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/core/model/rotation.hpp"

namespace fovea::config {

// Roll, pitch, yaw [deg] about fixed axes.
inline model::Mat3 RollPitchYaw(const std::vector<double>& degrees) {
  const double to_rad = std::numbers::pi / 180.0;
  const model::Mat3 roll = model::RotationOf({to_rad * degrees[0], 0.0, 0.0});
  const model::Mat3 pitch = model::RotationOf({0.0, to_rad * degrees[1], 0.0});
  return model::RotationOf({0.0, 0.0, to_rad * degrees[2]}) * pitch * roll;
}

// The inverse: roll, pitch, yaw [deg] of `R`, pitch from -90 to 90. At a pitch of -90 or 90 only the sum or
// the difference of roll and yaw is defined, and roll is set to 0.
inline std::array<double, 3> RollPitchYawOf(const model::Mat3& R) {
  const double to_deg = 180.0 / std::numbers::pi;
  const double level = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), level);
  if (level < 1e-9) {
    return {0.0, to_deg * pitch, to_deg * std::atan2(-R(0, 1), R(1, 1))};
  }
  return {to_deg * std::atan2(R(2, 1), R(2, 2)), to_deg * pitch, to_deg * std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace fovea::config
