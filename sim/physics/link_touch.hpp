// Whether an arm's links touch each other, or the target: by their collision shapes, whatever physics does
// about it.
//
// The bodies of physics meet the table alone: links pass through each other and through a target, as if
// nothing were there. That they would have touched is found here.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

class LinkTouch {
 public:
  // `target`: its shape in its own frame O; none: there is no target.
  LinkTouch(const SimRobot& robot, const std::optional<Shape>& target);
  ~LinkTouch();
  LinkTouch(const LinkTouch&) = delete;
  LinkTouch& operator=(const LinkTouch&) = delete;

  // The links are at `X_BL` (one per link of the robot), the target at `X_BO`.
  void Place(const std::vector<Eigen::Isometry3d>& X_BL, const Eigen::Isometry3d& X_BO);

  // Two links overlap. Links with at most two joints between them cannot but be near, and are not looked at.
  [[nodiscard]] bool Self() const;
  // A link overlaps the target.
  [[nodiscard]] bool Target() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
