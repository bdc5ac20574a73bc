// Triangle meshes of simple solids, built on the CPU.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

struct Vertex {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  Eigen::Vector3f colour;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise seen from outside

  // Adds `other`, moved to `X`.
  void Append(const Mesh& other, const Eigen::Isometry3f& X);
};

// A ball that holds all vertices of a mesh.
struct Bounds {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius = 0.0F;
};
Bounds FindBounds(const Mesh& mesh);

// Sizes are full extents [m]; `bevel` rounds the edges, so that they catch light (0: sharp).
// All about the origin.
Mesh MakeBox(const Eigen::Vector3f& size, float bevel, const Eigen::Vector3f& colour);
Mesh MakeCylinder(float radius, float length, float bevel, int segments, const Eigen::Vector3f& colour);
Mesh MakeSphere(float radius, int segments, const Eigen::Vector3f& colour);
// A robot's shape: with rounded edges that catch light, or as few triangles as a shadow needs.
enum class Detail { kPicture, kShadow };
Mesh MakeShape(const Shape& shape, Detail detail);

}  // namespace fovea::sim
