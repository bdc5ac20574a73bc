// SPDX-License-Identifier: Apache-2.0
// How the arm differs from what its own controller believes.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// The robot's controller compensates the weight of the robot that it believes in, at the angles that its
// encoders read, for an upright base. It commands torques by sensors that are wrong, too: they read what was
// commanded.
struct RobotTruth {
  Eigen::VectorXd encoder_zero;                         // reading at angle 0 [rad, m]; empty: 0
  Eigen::VectorXd torque_scale;                         // delivered share of a torque; empty: 1
  Eigen::VectorXd torque_bias;                          // delivered at torque 0 [Nm, N]; empty: 0
  Eigen::Vector2d base_tilt = Eigen::Vector2d::Zero();  // of the base about its x and y axes [rad]
  std::optional<SimRobot> believed;                     // with its load; none: the true one
};

}  // namespace fovea::sim
