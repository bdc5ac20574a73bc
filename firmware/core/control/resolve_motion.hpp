// Stage 3, first half: a task becomes joint velocities, with the limits on the motion inside.
//
// The limits are gathered as ranges of the joints' velocities and as rows across them (motion_limits.hpp):
// joint velocity and the end of each range, workspace, planes, boxes, singularity, the picture. Of all that
// keeps them, the joint velocity nearest to the task's is taken (resolve_constrained.hpp). So a joint at the
// end of its range hands its part over to the others, and a task along a boundary slides along it; limits
// that cut afterwards would have stopped it. (300 random starts, kinematic: 99 % reach their goal with the
// limits inside, 66 % with a damped pseudo-inverse whose result is cut:
// tests/core/control/resolve_compare.cpp.)
#pragma once

#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_constrained.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::control {

// Where the arm is, as far as its limits see it; all at the same q.
struct MotionScene {
  const trajectory::Reference& reference;
  const model::ArmPoses& poses;
  const model::LinearJacobian& J_E_B;  // of the end effector's point, in axes of B
  const model::Mat6N& J;               // body Jacobian of a frame of the hand, for the singularity
  const barriers::ViewedTarget* target =
      nullptr;             // what shall stay in the picture, and in sight; null: nothing
  bool by_joints = false;  // a motion of the joints, which no singularity of the hand holds up
};

struct ResolvedMotion {
  model::VecN dq;                    // [num_joints]
  bool finite = true;                // false: the task was not; dq is 0
  hal::LimitSet limits = 0;          // those that keep dq from the task's
  barriers::SingularityWatch watch;  // from tick to tick
};

// Real-time: yes.
void ResolveMotion(const config::ServoConfig& config, const MotionTask& task, const MotionScene& scene,
                   ResolvedMotion& motion) noexcept;

// What the arm would do with the freedom that a task leaves it (null_space_wish.hpp), as servo.posture_gain
// and its neighbours say. Real-time: yes.
[[nodiscard]] model::VecN FreeWish(const config::LawConfig& config, const model::ArmModel& arm,
                                   const model::VecN& q, const model::Mat6N& J) noexcept;

}  // namespace fovea::control
