// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/hull_points.hpp"

#include <cmath>
#include <numbers>
#include <set>

namespace fovea::sim {
namespace {

constexpr int kDirections = 512;

// Direction `i` of kDirections, evenly over the sphere: golden-angle steps about z, equal steps along z.
Eigen::Vector3f Direction(int i) {
  const double z = 1.0 - (2.0 * i + 1.0) / kDirections;
  const double r = std::sqrt(1.0 - z * z);
  const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
}

}  // namespace

std::vector<Eigen::Vector3d> HullPoints(const Mesh& mesh) {
  std::set<std::size_t> farthest;
  for (int i = 0; i < kDirections; ++i) {
    const Eigen::Vector3f direction = Direction(i);
    std::size_t best = 0;
    float best_distance = -INFINITY;
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
      const float distance = direction.dot(mesh.vertices[k].position);
      if (distance > best_distance) {
        best = k;
        best_distance = distance;
      }
    }
    farthest.insert(best);
  }
  std::vector<Eigen::Vector3d> points;
  points.reserve(farthest.size());
  for (const std::size_t k : farthest) {
    points.push_back(mesh.vertices[k].position.cast<double>());
  }
  return points;
}

}  // namespace fovea::sim
