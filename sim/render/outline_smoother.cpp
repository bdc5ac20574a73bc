// SPDX-License-Identifier: Apache-2.0
#include "sim/render/outline_smoother.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace fovea::sim {
namespace {

using Eigen::Vector3f;

// Corners closer than this are merged [m].
constexpr float kWeld = 1e-5F;

constexpr std::size_t kMostTriangles = 20'000;

using Corner = std::array<long, 3>;

Corner CornerOf(const Vector3f& p) {
  return {std::lround(p.x() / kWeld), std::lround(p.y() / kWeld), std::lround(p.z() / kWeld)};
}

}  // namespace

std::vector<MeshEdge> FindEdges(const Mesh& mesh) {
  if (mesh.num_triangles() > kMostTriangles) {
    return {};
  }
  // A triangle has its edges in its own winding order; its neighbour has them in the opposite direction.
  std::map<std::pair<Corner, Corner>, MeshEdge> half_edges;
  std::vector<MeshEdge> edges;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const std::array<const Vertex*, 3> v = {&mesh.vertices[mesh.indices[t]],
                                            &mesh.vertices[mesh.indices[t + 1]],
                                            &mesh.vertices[mesh.indices[t + 2]]};
    const Vector3f normal = (v[1]->position - v[0]->position).cross(v[2]->position - v[0]->position);
    if (normal.norm() < 1e-14F) {
      continue;  // no area: at a pole of a solid of revolution
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& from = *v[i];
      const Vertex& to = *v[(i + 1) % 3];
      const Corner a = CornerOf(from.position);
      const Corner b = CornerOf(to.position);
      const auto neighbour = half_edges.find({b, a});
      if (neighbour == half_edges.end()) {
        half_edges[{a, b}] = {from.position, to.position, normal.normalized(), Vector3f::Zero(), from.colour};
      } else {
        neighbour->second.normal_b = normal.normalized();
        edges.push_back(neighbour->second);
        half_edges.erase(neighbour);
      }
    }
  }
  return edges;
}

OutlineSmoother::OutlineSmoother() {
  glGenVertexArrays(1, &vertex_array_);
  glGenBuffers(1, &buffer_);
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  const std::size_t offsets[] = {offsetof(HemVertex, position), offsetof(HemVertex, other),
                                 offsetof(HemVertex, normal), offsetof(HemVertex, colour),
                                 offsetof(HemVertex, hem)};
  for (GLuint i = 0; i < 5; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, i == 4 ? 2 : 3, GL_FLOAT, GL_FALSE, sizeof(HemVertex),
                          reinterpret_cast<const void*>(offsets[i]));
  }
}

OutlineSmoother::~OutlineSmoother() {
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteBuffers(1, &buffer_);
}

void OutlineSmoother::Add(const std::vector<MeshEdge>& edges, const Eigen::Isometry3f& X_BM,
                          const Vector3f& eye_B) {
  const Vector3f eye_M = X_BM.inverse() * eye_B;
  for (const MeshEdge& edge : edges) {
    const Vector3f to_eye = eye_M - edge.from;
    const bool a_seen = edge.normal_a.dot(to_eye) > 0.0F;
    const bool b_seen = edge.normal_b.dot(to_eye) > 0.0F;
    if (a_seen == b_seen) {
      continue;
    }
    const Vector3f from = X_BM * edge.from;
    const Vector3f to = X_BM * edge.to;
    const Vector3f normal = X_BM.linear() * (a_seen ? edge.normal_a : edge.normal_b);
    const float out = a_seen ? 1.0F : -1.0F;
    const HemVertex a{from, to, normal, edge.colour, {out, 0.0F}};
    const HemVertex b{from, to, normal, edge.colour, {out, 1.0F}};
    // From the other end of the edge, the outward side is reversed.
    const HemVertex c{to, from, normal, edge.colour, {-out, 0.0F}};
    const HemVertex d{to, from, normal, edge.colour, {-out, 1.0F}};
    vertices_.insert(vertices_.end(), {a, b, c, c, b, d});
  }
}

void OutlineSmoother::Draw() {
  if (!vertices_.empty()) {
    glBindVertexArray(vertex_array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(HemVertex)),
                 vertices_.data(), GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
  }
  vertices_.clear();
}

}  // namespace fovea::sim
