// SPDX-License-Identifier: Apache-2.0
// Stage 3, first half: converts a task to joint velocities that keep all motion limits.
//
// The limits are ranges of the joint velocities and rows across them (motion_limits.hpp): joint velocity, the
// ends of each range, workspace, planes, boxes, singularity, the picture. The result is the joint velocity
// within the limits that is nearest to the task's (resolve_constrained.hpp). The other joints then take over
// from a joint at the end of its range, and a task slides along a boundary. Limits that cut the result
// afterwards would stop it. (300 random starts, kinematic: 99 % reach their goal with the limits inside, 66 %
// with a damped pseudo-inverse whose result is cut: tests/core/control/resolve_compare.cpp.)
#pragma once

#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_constrained.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::control {

// The arm's state as the limits use it; all at the same q.
struct MotionScene {
  const trajectory::Reference& reference;
  const model::ArmPoses& poses;
  const model::LinearJacobian& J_E_B;  // of the origin of E, in axes of B
  const model::Mat6N& J;               // body Jacobian of a frame of the hand, for the singularity
  const barriers::ViewedTarget* target = nullptr;  // to keep in view and in sight; null: none
  // The task is the joints' own motion (J = I, dq_0 = 0, weight 1). The hand's singularities do not limit it.
  bool by_joints = false;
  double speed_share = 1.0;  // of each joint's largest speed, 0 to 1
};

struct ResolvedMotion {
  model::VecN dq;                    // [num_joints]
  bool finite = true;                // false: the task was not; dq is 0
  hal::LimitSet limits = 0;          // those that make dq differ from the task's
  barriers::SingularityWatch watch;  // kept from tick to tick
};

// Real-time: yes.
void ResolveMotion(const config::ServoConfig& config, const MotionTask& task, const MotionScene& scene,
                   ResolvedMotion& motion) noexcept;

// The secondary task (null_space_wish.hpp) with the gains of servo.posture_gain and the keys beside it.
// Real-time: yes.
[[nodiscard]] model::VecN FreeWish(const config::LawConfig& config, const model::ArmModel& arm,
                                   const model::VecN& q, const model::Mat6N& J) noexcept;

}  // namespace fovea::control
