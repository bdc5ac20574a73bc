// SPDX-License-Identifier: Apache-2.0
// Reduces a mesh to few points with nearly the same convex hull, for collisions.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

// The outermost vertices of `mesh` in its own frame [m], at most 512. A solid with few corners keeps them
// all; otherwise the hull lies inside the mesh's hull by about 0.5 % of its radius.
std::vector<Eigen::Vector3d> HullPoints(const Mesh& mesh);

}  // namespace fovea::sim
