// SPDX-License-Identifier: Apache-2.0
// The visible parts of a robot's link, as meshes.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/render/mesh.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// One mesh for each of the link's solids, and one for the camera at `X_LC` (null: no camera on this link).
std::vector<Mesh> MakeParts(const SimLink& link, const Eigen::Isometry3f* X_LC, Detail detail);

Mesh Join(const std::vector<Mesh>& parts);

// Finds edges part by part, so that a part with too many triangles does not remove the edges of the others.
std::vector<MeshEdge> FindAllEdges(const std::vector<Mesh>& parts);

}  // namespace fovea::sim
