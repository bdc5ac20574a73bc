// Which way the arm takes to a target: the visual law's, or by the joints.
//
// The law takes each step that brings the feature nearer. That may end where a limit holds it, at a joint's
// end or along the workspace, although another posture reaches the goal. So such a posture is looked for
// (goal_posture.hpp): where the target leaves the hand no freedom all the while, for a disc or ball, that
// most often lets the law find one, only once limits let the goal come no nearer.
//
// The law goes first where a posture lies downhill. Where none does, the arm stands until one is found to
// which a way is clear, for a while at most. Where limits let the goal come no nearer, one is looked for from
// there. To it the joints go, all at once, by way of another posture when that is how it was found, as
// straight as the target's place in the picture and the limits let them. Near it the law takes over. All
// limits hold on both ways, but for the guard of the hand's singularities, which a motion of the joints
// passes.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/core/control/goal_posture.hpp"
#include "firmware/core/control/resolve_damped.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::control {

struct WayToGoal {
  GoalPosture goal;
  int ticks_to_step = 0;  // until the posture that was found follows the target again
  bool chosen = false;    // a way has been, on this track
  bool by_joints = false;
  bool preferred = false;      // that posture: the law has failed without it, and bends towards it
  std::int64_t since_ns = 0;   // when the way was last changed: it begins smoothly
  std::int64_t held_ns = 0;    // by the joints: how much longer limits have held them up than not
  std::int64_t sought_ns = 0;  // for how long the arm has stood while a posture is looked for
  std::int64_t stalled_ns =
      0;  // by the law: how much longer limits have acted than not since the goal came nearer
  double least_off = HUGE_VAL;  // how near it was [m], a turn counting a tenth of its angle
};

// What is known of target and arm in this tick.
struct WaySight {
  model::Pose X_BO;  // the estimate
  model::Pose X_CO;
  const model::VecN& q;      // [num_joints]
  hal::LimitSet limits = 0;  // that acted in the tick before
  std::int64_t now_ns = 0;
  std::int64_t track_since_ns = 0;
  bool is_told_apart = false;  // of the poses that the corners allow one is left
};

// Looks on for a posture, and chooses. Real-time: yes.
void ChooseWay(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept;

// The task of the way by the joints, in the place of the law's: all joints at once, to the posture with the
// target in view (way_in_view.hpp); to stand still while another one is looked for.
// `q` [num_joints]; `J_C`: body Jacobian of the camera; `p_CO_C_star` [m]. Real-time: yes.
void SteerByJoints(const WayToGoal& way, const model::VecN& q, const features::TargetInCamera& seen,
                   const model::Mat6N& J_C, const model::Vec3& p_CO_C_star, MotionTask& task) noexcept;

// Takes note of what became of that task: `dq` is what the limits left of it. True when they hold it up, or
// there is no way to go.
// Real-time: yes.
bool NoteHeld(const MotionTask& task, const model::VecN& dq, WayToGoal& way) noexcept;

// The limits that bar a way, and not only slow it.
inline constexpr hal::LimitSet kBarriers =
    hal::Bit(hal::Limit::kJointPosition) | hal::Bit(hal::Limit::kWorkspace) |
    hal::Bit(hal::Limit::kObstacle) | hal::Bit(hal::Limit::kSingularity) | hal::Bit(hal::Limit::kFieldOfView);

// `ns` a tick more where `holds`, else less, but not below 0. Real-time: yes.
void CountTick(bool holds, std::int64_t& ns) noexcept;

}  // namespace fovea::control
