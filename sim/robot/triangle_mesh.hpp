// SPDX-License-Identifier: Apache-2.0
// A triangle mesh: drawn for a solid, or read from a mesh file.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace fovea::sim {

struct Vertex {
  Eigen::Vector3f position;  // in the mesh's own frame [m]
  Eigen::Vector3f normal;    // unit vector
  Eigen::Vector3f colour;    // linear RGB, 0 to 1
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise seen from outside

  [[nodiscard]] std::size_t num_triangles() const { return indices.size() / 3; }

  // Adds `other`, moved to `X`.
  void Append(const Mesh& other, const Eigen::Isometry3f& X) {
    const auto base = static_cast<std::uint32_t>(vertices.size());
    for (const Vertex& v : other.vertices) {
      vertices.push_back({X * v.position, X.linear() * v.normal, v.colour});
    }
    for (const std::uint32_t i : other.indices) {
      indices.push_back(base + i);
    }
  }
};

}  // namespace fovea::sim
