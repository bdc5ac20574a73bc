// What is drawn of simple solids and of the robot's shapes, as triangles built on the CPU.
#pragma once

#include <Eigen/Geometry>

#include "sim/robot/sim_robot.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

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
