// SPDX-License-Identifier: Apache-2.0
// Hand guiding: a person's pull, and the enabling button.
#include <algorithm>

#include "sim/panda/robot.hpp"

namespace fovea::sim {

using franka::RobotMode;

void FciRobot::PressGuiding(bool pressed) {
  const RobotMode mode = state_.robot_mode;
  if (pressed &&
      (mode == RobotMode::kIdle || mode == RobotMode::kUserStopped || mode == RobotMode::kReflex)) {
    guiding_ = {mode, measured_.q, std::max(JointsBeyond(), 0.0), IsInWall()};
    state_.robot_mode = RobotMode::kGuiding;
  } else if (!pressed && mode == RobotMode::kGuiding) {
    reference_.Hold(measured_.q, measured_.dq);
    state_.robot_mode = guiding_.from;
  }
}

// Applies the person's pull as torques on the joints.
void FciRobot::PullAtJoints() {
  Joints tau = Joints::Zero();
  if (hand_force_B_ != Eigen::Vector3d::Zero()) {
    Jacobian J;
    const Eigen::Isometry3d X_BE = chain_.TipPose(world_.truth().q, J);
    const Eigen::Vector3d arm = X_BE.linear() * F_T_EE().translation();
    tau =
        J.topRows<3>().transpose() * hand_force_B_ + J.bottomRows<3>().transpose() * arm.cross(hand_force_B_);
  }
  world_.PullAt(tau);
}

}  // namespace fovea::sim
