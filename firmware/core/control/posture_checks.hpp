// What a posture must satisfy to be a goal, or to lie on the way to one.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

struct JointRange {
  double least;
  double most;
};

// Where a goal's joint `i` may be [rad, m]: inside the range that the reference keeps, with some room; in the
// middle of one that leaves none. Real-time: yes.
[[nodiscard]] JointRange RoomOfJoint(const config::ServoConfig& config, Eigen::Index i) noexcept;

// Whether the hand at `p_BE` [m] is inside the workspace and out of the obstacles, with some room.
// Real-time: yes.
[[nodiscard]] bool KeepsOut(const config::ServoConfig& config, const model::Pose& X_BE) noexcept;

// Whether the posture is clear of the singularities that the guard keeps it from. Real-time: yes.
[[nodiscard]] bool IsRegular(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept;

// Whether the arm's own links leave the target at `X_BO` in sight and the hand is clear of the first of them,
// and of the planes what comes from the elbow on. Real-time: yes.
[[nodiscard]] bool IsArmClear(const config::ServoConfig& config, const model::ArmPoses& poses,
                              const model::Pose& X_BO) noexcept;

// Whether the target is in the picture, and a flat one not seen from beside or behind. Real-time: yes.
[[nodiscard]] bool IsInView(const config::ServoConfig& config, const model::Pose& X_BC,
                            const model::Pose& X_BO) noexcept;

}  // namespace fovea::control
