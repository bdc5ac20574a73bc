// SPDX-License-Identifier: Apache-2.0
// A cuboid that the end effector may not enter, as GetCartesianLimit reports it.
#pragma once

#include "sim/panda/types.hpp"

namespace fovea::sim {

struct CartesianWall {
  Eigen::Isometry3d X_BW = Eigen::Isometry3d::Identity();  // frame W at a corner, axes along the edges
  Eigen::Vector3d size = Eigen::Vector3d::Zero();          // edge lengths along the axes of W [m]

  // Whether the point `p_B` [m, in B] is inside.
  [[nodiscard]] bool Holds(const Eigen::Vector3d& p_B) const {
    const Eigen::Vector3d p_W = X_BW.inverse() * p_B;
    return (p_W.array() > 0.0).all() && (p_W.array() < size.array()).all();
  }
};

}  // namespace fovea::sim
