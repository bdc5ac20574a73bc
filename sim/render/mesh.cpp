// SPDX-License-Identifier: Apache-2.0
#include "sim/render/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/render/simplify.hpp"

namespace fovea::sim {
namespace {

// A mesh with more triangles than this casts the shadow of a coarser mesh. Its cells [m] are half a texel of
// the camera's shadow map.
constexpr std::size_t kFewTriangles = 2000;
constexpr float kShadowCell = 0.004F;

constexpr float kPi = std::numbers::pi_v<float>;

// A point on the outline of a solid of revolution: radius, height, and the normal's two components.
struct RingPoint {
  float radius;
  float z;
  float normal_r;
  float normal_z;
};

// Revolves `outline`, given from the bottom up, about z. Two neighbours at the same place with different
// normals make a sharp edge.
Mesh Revolve(const std::vector<RingPoint>& outline, int segments, const Eigen::Vector3f& colour) {
  Mesh mesh;
  for (const RingPoint& p : outline) {
    for (int i = 0; i <= segments; ++i) {
      const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(segments);
      const float c = std::cos(angle);
      const float s = std::sin(angle);
      mesh.vertices.push_back(
          {{p.radius * c, p.radius * s, p.z}, {p.normal_r * c, p.normal_r * s, p.normal_z}, colour});
    }
  }
  const auto row = static_cast<std::uint32_t>(segments + 1);
  for (std::uint32_t r = 0; r + 1 < outline.size(); ++r) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = r * row + i;
      const std::uint32_t b = a + 1;
      const std::uint32_t c = a + row;
      const std::uint32_t d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

}  // namespace

Bounds FindBounds(const Mesh& mesh) {
  if (mesh.vertices.empty()) {
    return {};
  }
  Eigen::Vector3f low = mesh.vertices.front().position;
  Eigen::Vector3f high = low;
  for (const Vertex& v : mesh.vertices) {
    low = low.cwiseMin(v.position);
    high = high.cwiseMax(v.position);
  }
  Bounds bounds{0.5F * (low + high), 0.0F};
  for (const Vertex& v : mesh.vertices) {
    bounds.radius = std::max(bounds.radius, (v.position - bounds.centre).norm());
  }
  return bounds;
}

Mesh MakeCylinder(float radius, float length, float bevel, int segments, const Eigen::Vector3f& colour) {
  const int steps = bevel > 0.0F ? 3 : 1;
  const float b = std::min({bevel, 0.45F * length, 0.45F * radius});
  const float half = 0.5F * length;
  std::vector<RingPoint> outline;
  outline.push_back({0.0F, -half, 0.0F, -1.0F});
  for (int i = 0; i <= steps; ++i) {
    const float a = -0.5F * kPi + 0.5F * kPi * static_cast<float>(i) / static_cast<float>(steps);
    outline.push_back({radius - b + b * std::cos(a), -half + b + b * std::sin(a), std::cos(a), std::sin(a)});
  }
  for (int i = 0; i <= steps; ++i) {
    const float a = 0.5F * kPi * static_cast<float>(i) / static_cast<float>(steps);
    outline.push_back({radius - b + b * std::cos(a), half - b + b * std::sin(a), std::cos(a), std::sin(a)});
  }
  outline.push_back({0.0F, half, 0.0F, 1.0F});
  return Revolve(outline, segments, colour);
}

Mesh MakeSphere(float radius, int segments, const Eigen::Vector3f& colour) {
  const int rings = segments / 2;
  std::vector<RingPoint> outline;
  for (int i = 0; i <= rings; ++i) {
    const float a = -0.5F * kPi + kPi * static_cast<float>(i) / static_cast<float>(rings);
    outline.push_back({radius * std::cos(a), radius * std::sin(a), std::cos(a), std::sin(a)});
  }
  return Revolve(outline, segments, colour);
}

// Each face is a grid whose outer cells bend around the edge: a smaller box, moved out by `bevel`.
Mesh MakeBox(const Eigen::Vector3f& size, float bevel, const Eigen::Vector3f& colour) {
  Mesh mesh;
  const float b = std::min(bevel, 0.3F * size.minCoeff());
  const Eigen::Vector3f core = 0.5F * size - Eigen::Vector3f::Constant(b);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
      // Four lines each way: edge, start of the flat part, its end, edge. At an edge the normal leans by 45
      // degrees towards the neighbouring face.
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
          const float lean_u = i == 0 ? -1.0F : i == 3 ? 1.0F : 0.0F;
          const float lean_v = j == 0 ? -1.0F : j == 3 ? 1.0F : 0.0F;
          Eigen::Vector3f normal = Eigen::Vector3f::Zero();
          normal[axis] = side;
          normal[u] = lean_u;
          normal[v] = lean_v;
          normal.normalize();
          Eigen::Vector3f corner;
          corner[axis] = side * core[axis];
          corner[u] = i < 2 ? -core[u] : core[u];
          corner[v] = j < 2 ? -core[v] : core[v];
          mesh.vertices.push_back({corner + b * normal, normal, colour});
        }
      }
      for (std::uint32_t j = 0; j < 3; ++j) {
        for (std::uint32_t i = 0; i < 3; ++i) {
          const std::uint32_t a = base + 4 * j + i;
          if (side > 0) {
            mesh.indices.insert(mesh.indices.end(), {a, a + 1, a + 5, a, a + 5, a + 4});
          } else {
            mesh.indices.insert(mesh.indices.end(), {a, a + 5, a + 1, a, a + 4, a + 5});
          }
        }
      }
    }
  }
  return mesh;
}

Mesh MakeShape(const Shape& shape, Detail detail) {
  const Eigen::Vector3f size = shape.size.cast<float>();
  const bool picture = detail == Detail::kPicture;
  const float bevel = picture ? 0.008F : 0.0F;
  const int segments = picture ? 40 : 12;
  Mesh mesh;
  switch (shape.kind) {
    case ShapeKind::kBox: mesh = MakeBox(size, bevel, shape.colour); break;
    case ShapeKind::kCylinder: mesh = MakeCylinder(size[0], size[1], bevel, segments, shape.colour); break;
    case ShapeKind::kSphere: mesh = MakeSphere(size[0], segments, shape.colour); break;
    case ShapeKind::kMesh:
      mesh = picture || shape.mesh->num_triangles() <= kFewTriangles ? *shape.mesh
                                                                     : Simplify(*shape.mesh, kShadowCell);
      break;
  }
  Mesh placed;
  placed.Append(mesh, shape.X_LS.cast<float>());
  return placed;
}

}  // namespace fovea::sim
