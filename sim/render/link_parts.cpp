// SPDX-License-Identifier: Apache-2.0
#include "sim/render/link_parts.hpp"

namespace fovea::sim {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

Mesh MakeCameraHousing() {
  Mesh mesh;
  const Vector3f dark(0.07F, 0.075F, 0.08F);
  const Vector3f ring(0.05F, 0.42F, 0.58F);
  const auto at = [](float z) { return Isometry3f(Eigen::Translation3f(0.0F, 0.0F, z)); };
  mesh.Append(MakeBox({0.034F, 0.034F, 0.040F}, 0.004F, dark), at(-0.042F));
  mesh.Append(MakeCylinder(0.0155F, 0.022F, 0.002F, 32, dark), at(-0.013F));
  mesh.Append(MakeCylinder(0.0160F, 0.003F, 0.001F, 32, ring), at(-0.018F));
  return mesh;
}

}  // namespace

std::vector<Mesh> MakeParts(const SimLink& link, const Isometry3f* X_LC, Detail detail) {
  std::vector<Mesh> parts;
  for (const Shape& shape : link.visuals) {
    parts.push_back(MakeShape(shape, detail));
  }
  if (X_LC != nullptr) {
    parts.emplace_back().Append(MakeCameraHousing(), *X_LC);
  }
  return parts;
}

Mesh Join(const std::vector<Mesh>& parts) {
  Mesh mesh;
  for (const Mesh& part : parts) {
    mesh.Append(part, Isometry3f::Identity());
  }
  return mesh;
}

std::vector<MeshEdge> FindAllEdges(const std::vector<Mesh>& parts) {
  std::vector<MeshEdge> edges;
  for (const Mesh& part : parts) {
    const std::vector<MeshEdge> own = FindEdges(part);
    edges.insert(edges.end(), own.begin(), own.end());
  }
  return edges;
}

}  // namespace fovea::sim
