// What a link of the robot looks like, solid by solid.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/render/mesh.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// A link's solids and, on the tip link, the camera at `X_LC` (null: there is none); each by itself.
std::vector<Mesh> MakeParts(const SimLink& link, const Eigen::Isometry3f* X_LC, Detail detail);

Mesh Join(const std::vector<Mesh>& parts);

// Found part by part, so that a dense one does not cost the others theirs.
std::vector<MeshEdge> FindAllEdges(const std::vector<Mesh>& parts);

}  // namespace fovea::sim
