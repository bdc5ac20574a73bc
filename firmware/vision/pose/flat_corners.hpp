// SPDX-License-Identifier: Apache-2.0
// The corners of a flat target in its own plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "firmware/core/features/polygon.hpp"

namespace fovea::vision {

// (x, y) in O [m], in the order of `polygon`. Its third coordinates are 0.
inline std::vector<Eigen::Vector2d> FlatCorners(const features::Polygon& polygon) {
  std::vector<Eigen::Vector2d> corners;
  corners.reserve(static_cast<std::size_t>(polygon.num_corners));
  for (int i = 0; i < polygon.num_corners; ++i) {
    corners.emplace_back(polygon.corners[static_cast<std::size_t>(i)].head<2>());
  }
  return corners;
}

}  // namespace fovea::vision
