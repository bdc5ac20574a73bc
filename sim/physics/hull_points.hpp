// Few points whose convex hull is, nearly, that of many: what a collision with a mesh is computed with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

// The vertices of `mesh` that lie farthest out, in the mesh's frame [m]: all corners of a solid with few, and
// of any other at most 512, whose hull lies inside the mesh's own by some 0.5 % of its radius.
std::vector<Eigen::Vector3d> HullPoints(const Mesh& mesh);

}  // namespace fovea::sim
