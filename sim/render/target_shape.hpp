// SPDX-License-Identifier: Apache-2.0
// The target's shape for the renderer. Flat targets are painted plates. Looking at the painted side, frame O
// has x right, y down and z into the plate.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fovea::sim {

struct TargetShape {
  enum class Kind { kBall, kDisc, kPolygon };
  Kind kind = Kind::kBall;
  double radius = 0.04;                  // of ball and disc [m]
  std::vector<Eigen::Vector2d> corners;  // of a convex polygon, in order [m]

  // Largest distance of its outline from its centre [m].
  [[nodiscard]] double Reach() const {
    double reach = kind == Kind::kPolygon ? 0.0 : radius;
    for (const Eigen::Vector2d& corner : corners) {
      reach = reach < corner.norm() ? corner.norm() : reach;
    }
    return reach;
  }
};

}  // namespace fovea::sim
