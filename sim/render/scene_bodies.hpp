// SPDX-License-Identifier: Apache-2.0
// The bench's things and the robot's links on the graphics processor. An OpenGL context must be current.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "sim/render/bench.hpp"
#include "sim/render/cover.hpp"
#include "sim/render/gpu_mesh.hpp"
#include "sim/render/outline_smoother.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// A static thing, with its bounds to skip it when it is out of view.
struct Thing {
  std::unique_ptr<GpuMesh> mesh;
  std::vector<MeshEdge> edges;
  Bounds bounds;
  Box box;
};

// A link's meshes for the picture and for its shadow.
struct Link {
  std::unique_ptr<GpuMesh> mesh;
  std::unique_ptr<GpuMesh> shadow;
  std::vector<MeshEdge> edges;
  Bounds bounds;
  std::vector<Box> shapes;  // tighter bounds: one box per solid
};

std::vector<Thing> UploadThings(const Bench& bench);

// `X_EC`: pose of the camera on the tip link; null: no camera's housing.
std::vector<Link> UploadLinks(const SimRobot& robot, const Eigen::Isometry3d* X_EC);

}  // namespace fovea::sim
