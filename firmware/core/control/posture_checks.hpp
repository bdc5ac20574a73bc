// SPDX-License-Identifier: Apache-2.0
// Checks of a posture that is a goal, or that lies on the path to one.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

struct JointRange {
  double least;
  double most;
};

// The range of joint `i` at a goal [rad, m]: the reference's range less some room; its middle if that leaves
// nothing. Real-time: yes.
[[nodiscard]] JointRange RoomOfJoint(const config::ServoConfig& config, Eigen::Index i) noexcept;

// True if the hand at `X_BE` is inside the workspace and clear of the obstacles, with some room.
// Real-time: yes.
[[nodiscard]] bool KeepsOut(const config::ServoConfig& config, const model::Pose& X_BE) noexcept;

// True if the posture is further from a singularity than the guard requires, with some room. Real-time: yes.
[[nodiscard]] bool IsRegular(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept;

// True if the arm's links are clear of each other and of the lines of sight to the target at `X_BO`, and the
// outer links of the planes, with some room. Real-time: yes.
[[nodiscard]] bool IsArmClear(const config::ServoConfig& config, const model::ArmPoses& poses,
                              const model::Pose& X_BO) noexcept;

// True if the target is in the picture and, if it is flat, seen from the front and not too obliquely.
// Real-time: yes.
[[nodiscard]] bool IsInView(const config::ServoConfig& config, const model::Pose& X_BC,
                            const model::Pose& X_BO) noexcept;

}  // namespace fovea::control
