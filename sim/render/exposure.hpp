// SPDX-License-Identifier: Apache-2.0
// The world at one exposure: everything needed to draw the camera's picture.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

namespace fovea::sim {

// The frame that pixels come from.
struct PixelSource {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
};

struct Exposure {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;  // mid-exposure
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();  // target's centre [m]
  Eigen::Matrix3d R_BO = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Isometry3d> X_BL;  // one per link of the robot

  // Faults of the camera.
  std::optional<PixelSource> pixels_of;  // the pixels are those of this frame, noise included
  std::int64_t stamp_error_ns = 0;       // the frame's stamp is stamp_ns plus this
};

}  // namespace fovea::sim
