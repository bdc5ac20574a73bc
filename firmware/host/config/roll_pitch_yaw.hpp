// Orientations as configurations write them.
#pragma once

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

}  // namespace fovea::config
