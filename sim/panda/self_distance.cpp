// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/self_distance.hpp"

#include <algorithm>
#include <limits>

namespace fovea::sim {
namespace {

constexpr std::size_t kNeighbours = 2;  // links at most this many joints apart are always close

// Distance of two segments a_0 b_0 and a_1 b_1 (Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
double SegmentDistance(const Eigen::Vector3d& a_0, const Eigen::Vector3d& b_0, const Eigen::Vector3d& a_1,
                       const Eigen::Vector3d& b_1) {
  constexpr double kPoint = 1e-12;  // a segment with a squared length below this is a point [m^2]
  const Eigen::Vector3d d_0 = b_0 - a_0;
  const Eigen::Vector3d d_1 = b_1 - a_1;
  const Eigen::Vector3d r = a_0 - a_1;
  const double a = d_0.squaredNorm();
  const double e = d_1.squaredNorm();
  const double b = d_0.dot(d_1);
  const double c = d_0.dot(r);
  const double f = d_1.dot(r);
  const double denominator = a * e - b * b;
  double s = denominator > kPoint ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = e > kPoint ? (b * s + f) / e : 0.0;
  if (t < 0.0 || t > 1.0 || e <= kPoint) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > kPoint ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0.0;
  }
  return (r + s * d_0 - t * d_1).norm();
}

}  // namespace

SelfDistance::SelfDistance(const SimRobot& robot) {
  std::vector<std::size_t> rank(robot.links.size(), 0);
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    const SimLink& link = robot.links[k];
    if (link.parent >= 0) {
      rank[k] = rank[static_cast<std::size_t>(link.parent)] + (link.dof >= 0 ? 1U : 0U);
    }
    for (const Shape& shape : link.collisions) {
      if (shape.kind == ShapeKind::kCylinder || shape.kind == ShapeKind::kSphere) {
        const double half = shape.kind == ShapeKind::kCylinder ? 0.5 * shape.size[1] : 0.0;
        capsules_.push_back({k, rank[k], shape.X_LS * Eigen::Vector3d(0.0, 0.0, -half),
                             shape.X_LS * Eigen::Vector3d(0.0, 0.0, half), shape.size[0]});
      }
    }
  }
}

double SelfDistance::Least(const std::vector<Eigen::Isometry3d>& X_BL) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    for (std::size_t j = i + 1; j < capsules_.size(); ++j) {
      const Capsule& one = capsules_[i];
      const Capsule& other = capsules_[j];
      if (std::max(one.rank, other.rank) - std::min(one.rank, other.rank) > kNeighbours) {
        const Eigen::Isometry3d& X_0 = X_BL[one.link];
        const Eigen::Isometry3d& X_1 = X_BL[other.link];
        least =
            std::min(least, SegmentDistance(X_0 * one.a_L, X_0 * one.b_L, X_1 * other.a_L, X_1 * other.b_L) -
                                one.radius - other.radius);
      }
    }
  }
  return least;
}

}  // namespace fovea::sim
