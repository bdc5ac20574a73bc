// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/picture_target.hpp"

#include <algorithm>
#include <limits>

namespace fovea::bench {
vision::DetectorConfig ConfigOf(TargetKind kind, const PictureCamera& camera, vision::FindBy by) {
  vision::DetectorConfig config;
  config.LookFor(TargetOf(kind));
  config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                       camera.f_px,     camera.c_u_px,    camera.c_v_px};
  config.by = by;
  config.distance_min = 0.10;
  config.distance_max = 2.2;
  return config;
}

std::vector<Eigen::Vector2d> CornersOf(const vision::Detection& detection) {
  std::vector<Eigen::Vector2d> corners;
  corners.reserve(detection.Corners().size());
  for (const vision::ImagePoint& p : detection.Corners()) {
    corners.emplace_back(p.u_px, p.v_px);
  }
  return corners;
}

double OffOf(const Eigen::Vector2d& middle, std::span<const Eigen::Vector2d> corners,
             const TrueOutline& truth, std::size_t corner_count) {
  const double off_px = (middle - Eigen::Vector2d(truth.u_px, truth.v_px)).norm();
  if (corners.size() != corner_count || corner_count == 0) {
    return off_px;
  }
  const std::size_t per_side = truth.points.size() / corner_count;
  double least_px = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < corner_count; ++first) {
    double furthest_px = 0.0;
    for (std::size_t i = 0; i < corner_count; ++i) {
      const Eigen::Vector2d& corner = truth.points[((first + i) % corner_count) * per_side];
      furthest_px = std::max(furthest_px, (corners[i] - corner).norm());
    }
    least_px = std::min(least_px, furthest_px);
  }
  return std::max(off_px, least_px);
}

double OffOf(const vision::Detection& detection, const PictureScene& scene) {
  const Body& body = scene.bodies.front();
  return OffOf(Eigen::Vector2d(detection.u_px, detection.v_px), CornersOf(detection),
               OutlineOf(scene.camera, body), body.corners.size());
}

}  // namespace fovea::bench
