// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/outline.hpp"

#include "firmware/vision/find/curve.hpp"

namespace fovea::vision {

std::vector<ImagePoint> SphereOutline(const Intrinsics& intrinsics, const model::Vec3& m, int count) {
  ConeCurve cone;
  cone.p = m;
  std::vector<Eigen::Vector2d> ellipse(static_cast<std::size_t>(count));
  EllipsePoints(cone.Conic(intrinsics), ellipse);
  std::vector<ImagePoint> points;
  points.reserve(ellipse.size());
  for (const Eigen::Vector2d& p : ellipse) {
    points.push_back({p.x(), p.y()});
  }
  return points;
}

}  // namespace fovea::vision
