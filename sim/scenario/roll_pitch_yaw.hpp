// SPDX-License-Identifier: Apache-2.0
// Orientations in a scenario. Does not use the code of firmware/host/config: the truth must share no code
// with the servo that it judges.
#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <vector>

namespace fovea::sim {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Roll, pitch, yaw [deg] about fixed axes.
inline Eigen::Quaterniond RollPitchYaw(const std::vector<double>& degrees) {
  const Eigen::Vector3d rpy = kRadPerDeg * Eigen::Vector3d(degrees[0], degrees[1], degrees[2]);
  return Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
}

}  // namespace fovea::sim
