// SPDX-License-Identifier: Apache-2.0
// Chooses how the arm moves to a target: by the visual law, or by a joint motion.
//
// The law always reduces the feature's error. A limit, such as the end of a joint's range or the workspace's
// edge, may stop it although another posture reaches the goal. The servo therefore searches for such a
// posture (goal_posture.hpp). If the target leaves the hand no freedom, it searches all the time. For a disc
// or ball, where the law usually succeeds, it searches only after limits have stopped the progress.
//
// If the search that starts at the arm's posture finds one, the law starts first. Otherwise the arm
// waits, for a limited time, until a posture with a clear path is found. If limits stop the progress, the
// search starts from there. The joints then move to the posture together, by the detour with which it was
// found, as straight as the target's place in the picture and the limits allow. Near the posture the law
// takes over. All limits apply to both, except the guard of the hand's singularities, which a joint motion
// may cross.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/core/control/goal_posture.hpp"
#include "firmware/core/control/resolve_damped.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::control {

struct WayToGoal {
  GoalPosture goal;
  int ticks_to_step = 0;  // until the posture found is next adapted to the target
  bool chosen = false;    // a way was chosen since Track began
  bool by_joints = false;
  bool preferred = false;       // the law failed without the posture found, and is now pulled towards it
  std::int64_t since_ns = 0;    // time of the last change of the way, which starts smoothly
  std::int64_t held_ns = 0;     // joint motion: time held up by limits less time not held up
  std::int64_t sought_ns = 0;   // how long the arm has waited for a posture
  std::int64_t stalled_ns = 0;  // law: time with active limits less time without, since the last progress
  double least_off = HUGE_VAL;  // smallest distance from the goal [m]; a turn of 1 rad counts as 0.1 m
};

// What is known of target and arm in this tick.
struct WaySight {
  model::Pose X_BO;  // the estimate
  model::Pose X_CO;
  const model::VecN& q;      // [num_joints]
  hal::LimitSet limits = 0;  // active in the previous tick
  std::int64_t now_ns = 0;
  std::int64_t track_since_ns = 0;
  bool is_told_apart = false;  // only one of the poses that fit the corners is left
};

// Continues the search for a posture, and chooses the way. Real-time: yes.
void ChooseWay(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept;

// Replaces the law's task by a joint motion: all joints together to the posture found, with the target in
// view (way_in_view.hpp). While no posture is found, the task is to stand still. `q` [num_joints]; `J_C`:
// body Jacobian of the camera; `p_CO_C_star` [m]. Real-time: yes.
void SteerByJoints(const WayToGoal& way, const model::VecN& q, const features::TargetInCamera& seen,
                   const model::Mat6N& J_C, const model::Vec3& p_CO_C_star, MotionTask& task) noexcept;

// Records what the limits left of that task, `dq`. True if they block it, or no posture was found in time.
// Real-time: yes.
bool NoteHeld(const MotionTask& task, const model::VecN& dq, WayToGoal& way) noexcept;

// The limits that can block a path. All others only slow the motion down.
inline constexpr hal::LimitSet kBarriers =
    hal::Bit(hal::Limit::kJointPosition) | hal::Bit(hal::Limit::kWorkspace) |
    hal::Bit(hal::Limit::kObstacle) | hal::Bit(hal::Limit::kSingularity) | hal::Bit(hal::Limit::kFieldOfView);

// Adds a tick to `ns` if `holds`, else subtracts one, but not below 0. Real-time: yes.
void CountTick(bool holds, std::int64_t& ns) noexcept;

}  // namespace fovea::control
