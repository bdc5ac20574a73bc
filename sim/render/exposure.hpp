// SPDX-License-Identifier: Apache-2.0
// The world during one exposure: everything needed to draw the camera's picture.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fovea::sim {

// Camera, target and arm at one instant.
struct Moment {
  std::int64_t time_ns = 0;
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();  // target's centre [m]
  Eigen::Matrix3d R_BO = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Isometry3d> X_BL;  // one per link of the robot
};

// The moment at `time_ns`, between two others: places linear in time, turns at constant rate.
Moment Between(const Moment& before, const Moment& after, std::int64_t time_ns);

// The frame that pixels come from.
struct PixelSource {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;
};

// The moment is the middle of the exposure: of the middle row, if the rows are exposed one after the other.
struct Exposure : Moment {
  std::uint64_t sequence = 0;
  std::int64_t stamp_ns = 0;  // of the frame; time_ns, unless a fault shows an older scene
  // In order of time, over the whole exposure; null: the picture shows one moment.
  std::shared_ptr<const std::vector<Moment>> around;

  // Faults of the camera.
  std::optional<PixelSource> pixels_of;  // the pixels are those of this frame, noise included
  std::int64_t stamp_error_ns = 0;       // the frame's stamp is stamp_ns plus this

  // The moment `offset_ns` after the middle. Outside `around`: its first or last.
  [[nodiscard]] Moment At(std::int64_t offset_ns) const;
};

}  // namespace fovea::sim
