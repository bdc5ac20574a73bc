// SPDX-License-Identifier: Apache-2.0
// A joint path to a posture that keeps the target at its goal place in the picture.
//
// A straight joint path swings the camera away from the target. This path omits the part that would move the
// target in the image, and corrects the target's distance x - x* from its goal place there:
//   v = d - A^T (A A^T)^-1 (A d + x - x*),   A = L_x J_C  [2 x num_joints],   d = q_goal - q.
// At the goal posture the target is at x*, so that the path ends there. It may get stuck before.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

// `to_goal` [num_joints] = q_goal - q; `J_C`: body Jacobian of the camera; `p_CO_C_star`: the target's goal
// place [m]. Returns the direction to move, about as long as `to_goal`; `to_goal` itself if the target's
// centre is not in front of the camera. Real-time: yes.
[[nodiscard]] model::VecN WayInView(const model::VecN& to_goal, const features::TargetInCamera& seen,
                                    const model::Mat6N& J_C, const model::Vec3& p_CO_C_star) noexcept;

// A trial of that path ahead of time, one step at a time.
struct WayTrial {
  model::VecN q;  // [num_joints] posture reached so far; starts at the arm's
  int steps = 0;
  double length = 0.0;  // so far [rad]
  bool barred = false;  // target out of view or sight, hand or arm not clear, or stuck
};

// One step towards `q_goal` [num_joints]; `X_BO`: the target's estimate. False at its end. Real-time: yes.
[[nodiscard]] bool StepOnWay(const config::ServoConfig& config, const model::Pose& X_BO,
                             const model::VecN& q_goal, WayTrial& way) noexcept;

}  // namespace fovea::control
