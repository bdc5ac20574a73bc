// SPDX-License-Identifier: Apache-2.0
// Detects contacts of an arm's links with each other and with the target, by their collision shapes.
//
// The physics lets links collide only with the table; they pass through each other and through the target.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

class LinkTouch {
 public:
  // `target`: the target's shape in its own frame O; empty: no target.
  LinkTouch(const SimRobot& robot, const std::optional<Shape>& target);
  ~LinkTouch();
  LinkTouch(const LinkTouch&) = delete;
  LinkTouch& operator=(const LinkTouch&) = delete;

  // Sets the poses of the links (`X_BL`, one per link of the robot) and of the target (`X_BO`).
  void Place(const std::vector<Eigen::Isometry3d>& X_BL, const Eigen::Isometry3d& X_BO);

  // Whether two links overlap. Skips links with at most two joints between them, which are always close.
  [[nodiscard]] bool Self() const;
  // Whether a link overlaps the target.
  [[nodiscard]] bool Target() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
