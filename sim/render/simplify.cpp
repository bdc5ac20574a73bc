// SPDX-License-Identifier: Apache-2.0
#include "sim/render/simplify.hpp"

#include <array>
#include <cmath>
#include <map>

namespace fovea::sim {

Mesh Simplify(const Mesh& mesh, float cell) {
  Mesh simple;
  std::map<std::array<long, 3>, std::uint32_t> cells;
  std::vector<std::uint32_t> merged;  // for each vertex of `mesh`, the vertex that replaces it
  std::vector<float> counts;
  merged.reserve(mesh.vertices.size());
  for (const Vertex& v : mesh.vertices) {
    const std::array<long, 3> key = {std::lround(v.position.x() / cell), std::lround(v.position.y() / cell),
                                     std::lround(v.position.z() / cell)};
    const auto [it, is_new] = cells.emplace(key, static_cast<std::uint32_t>(simple.vertices.size()));
    if (is_new) {
      simple.vertices.push_back(v);
      counts.push_back(1.0F);
    } else {
      simple.vertices[it->second].position += v.position;
      counts[it->second] += 1.0F;
    }
    merged.push_back(it->second);
  }
  for (std::size_t i = 0; i < simple.vertices.size(); ++i) {
    simple.vertices[i].position /= counts[i];
  }
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const std::uint32_t a = merged[mesh.indices[t]];
    const std::uint32_t b = merged[mesh.indices[t + 1]];
    const std::uint32_t c = merged[mesh.indices[t + 2]];
    if (a != b && b != c && c != a) {
      simple.indices.insert(simple.indices.end(), {a, b, c});
    }
  }
  return simple;
}

}  // namespace fovea::sim
