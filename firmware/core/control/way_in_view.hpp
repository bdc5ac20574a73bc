// The joints' way to a posture with the target in the picture's middle.
//
// A straight way of the joints swings the camera past the target. Of that way the part is left out that would
// move the target away from where the goal has it in the image, and what it is away from there is taken back:
//   v = d - A^T (A A^T)^-1 (A d + x - x*),   A = L_x J_C  [2 x num_joints],   d = q_goal - q.
// The goal itself has the target there, so that the way ends in it; it may get stuck before.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

// `to_goal` [num_joints] = q_goal - q; `J_C`: body Jacobian of the camera; `p_CO_C_star`: where the target
// shall be [m]. Returns the direction to go, about as long; `to_goal` itself where the target's centre is not
// before the camera. Real-time: yes.
[[nodiscard]] model::VecN WayInView(const model::VecN& to_goal, const features::TargetInCamera& seen,
                                    const model::Mat6N& J_C, const model::Vec3& p_CO_C_star) noexcept;

// That way tried ahead, a step at a time.
struct WayTrial {
  model::VecN q;  // where it has come to; from where the arm is
  int steps = 0;
  double length = 0.0;  // so far [rad]
  bool barred = false;  // it leaves the picture, the line of sight or where the hand may be, or gets stuck
};

// One step towards `q_goal` [num_joints]; `X_BO`: the target's estimate. False when the way is at its end.
// Real-time: yes.
[[nodiscard]] bool StepOnWay(const config::ServoConfig& config, const model::Pose& X_BO,
                             const model::VecN& q_goal, WayTrial& way) noexcept;

}  // namespace fovea::control
