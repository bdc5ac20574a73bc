// SPDX-License-Identifier: Apache-2.0
// Triangle meshes of simple solids and of the robot's shapes, built on the CPU.
#pragma once

#include <Eigen/Geometry>

#include "sim/robot/sim_robot.hpp"
#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

// A bounding sphere of a mesh.
struct Bounds {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius = 0.0F;
};
Bounds FindBounds(const Mesh& mesh);

// Solids centred at the origin. Sizes are full extents [m]; `bevel` rounds the edges [m] (0: sharp).
Mesh MakeBox(const Eigen::Vector3f& size, float bevel, const Eigen::Vector3f& colour);
Mesh MakeCylinder(float radius, float length, float bevel, int segments, const Eigen::Vector3f& colour);
Mesh MakeSphere(float radius, int segments, const Eigen::Vector3f& colour);
// A robot's shape: with rounded edges for the picture, or with few triangles for its shadow.
enum class Detail { kPicture, kShadow };
Mesh MakeShape(const Shape& shape, Detail detail);

}  // namespace fovea::sim
