// SPDX-License-Identifier: Apache-2.0
// Chooses how the arm goes to a target: by the visual law, or along a plan of the planner beside the tick.
//
// The law always reduces the feature's error. A limit, such as the end of a joint's range or the workspace's
// edge, may stop it although another posture reaches the goal; and far from the goal it is slow. So a servo
// that is far from its goal stands still, asks for a plan (firmware/planning), and follows it:
//
//   law -> await plan -> plan -> law         near the goal, at its end
//             |           |
//             |           +-> await plan     limits hold it up, or the target is elsewhere
//             |           +-> law            the target is elsewhere, and moves or was elsewhere a moment ago
//             +-> law                        no plan in time, none found, or not for this start and target
//
// The servo also asks if limits stop the law. After some tries for the same goal it stays with the law. A
// target that keeps moving gets at most one new plan a second. A plan is for the target as it was estimated
// at the start. While the arm follows it, the plan's end moves with the estimate: the joints' path is shifted
// by a share that grows from 0 to 1,
//
//   q(t) = plan(t) + SmoothStep(t / T) J_C^+(q_end) xi,
//
// where xi is the twist that takes the camera from the planned goal to the present one. A plan begins slowly,
// and waits while the target is not seen: its motion is quick, so that an eye that is not as the servo
// believes has to be noticed early. All limits apply, except the guard of the hand's singularities, which a
// joint motion may cross.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_damped.hpp"
#include "firmware/core/control/swing.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::control {

struct WayToGoal {
  hal::WayNote note;
  int turn = 0;                 // the equal turn of the target that is its goal
  bool turn_known = false;      // it was chosen since Track began
  bool is_fresh = true;         // no plan was asked for since the goal was last near
  bool is_new_goal = true;      // the goal was near since the last plan for a far one
  bool is_there = false;        // law: so near to its goal that no plan would help
  bool keeps_posture = false;   // q_end reaches the goal: the law is pulled towards it
  std::int64_t since_ns = 0;    // time of the last change of the way, which starts smoothly
  std::int64_t asked_ns = -1;   // when the last plan or horizon was asked for; -1: none since the way changed
  std::int64_t stalled_ns = 0;  // law: time with active limits less time without, since the last progress
  std::int64_t held_ns = 0;     // plan: time held up less time not held up
  std::int64_t horizon_ns = -1;  // law: start of the horizon that the arm follows; -1: it follows none
  std::int64_t taken_ns = -1;    // start of the last horizon that came
  std::int64_t late_ns = -1;     // when a plan was asked for that was late and has not come since; -1: none
  std::int64_t again_ns = 0;     // no new plan is asked for before because the target moved
  double pace = 1.0;             // law: share of its speed
  double least_off = HUGE_VAL;   // law: smallest distance from the goal [m]; a turn of 1 rad counts as 0.1 m
  double t = 0.0;                // plan: time along it [s]
  double trust = 0.0;            // in the eye, 0 to 1: how fast a plan is followed
  Swing swing;                   // law: about a disc whose two poses are not told apart
  model::VecN shift;             // plan: of its end, for the present estimate [num_joints]
  model::VecN q_end;             // of the last plan [num_joints]
  model::Pose X_BC_end;          // of the camera at q_end
  model::Vec3 p_BO_end = model::Vec3::Zero();  // the target that it reaches [m]
  model::Mat6N pull;                           // transposed: a twist of the camera at q_end to joints

  [[nodiscard]] bool IsPlannerLate() const noexcept { return late_ns >= 0; }
  // A new try, from Track's beginning.
  void Restart() noexcept;
};

// What is known of target and arm in this tick.
struct WaySight {
  model::Pose X_BO;  // the estimate
  model::Pose X_CO;
  model::Vec3 v_BO;  // [m/s]
  model::Vec3 w_BO;  // [rad/s]; 0 if no orientation is seen
  model::Vec3 normal_B;
  const trajectory::Reference& reference;
  hal::LimitSet limits = 0;  // active in the previous tick
  std::int64_t now_ns = 0;
  bool is_told_apart = false;     // a plan for the believed pose suits all poses that fit the corners
  bool has_answer = false;        // the plan that was asked for is there
  bool is_seen = false;           // the target, at present
  bool is_eye_trusted = false;    // the picture has gone with the hand's motion since Track began
  bool is_eye_suspected = false;  // it seems to go against it
};

// Chooses the way. `plan`: the last one that was asked for and came. Real-time: yes.
void ChooseWay(const config::ServoConfig& config, const WaySight& sight, const trajectory::Plan& plan,
               WayToGoal& way) noexcept;

// The joints' motion in the next tick on a plan.
struct PlanStep {
  MotionTask task;
  model::VecN ddq;  // [num_joints]
};
// Only in way kPlan. Moves the plan's time on; a plan that the reference cannot follow waits for it.
// Real-time: yes.
void FollowPlan(const config::ServoConfig& config, const trajectory::Plan& plan,
                const trajectory::Reference& reference, bool is_seen, WayToGoal& way,
                PlanStep& step) noexcept;

// The law's pace with which an arm that awaits a plan comes to rest; 0: it stops at once, because it is slow.
// A stop of the joints would end the law's motion, but not keep the target in the picture: a turn of the
// camera that makes up for its shift may end later. Real-time: yes.
[[nodiscard]] double SlowingPace(const WayToGoal& way, const trajectory::Reference& reference) noexcept;

// True if limits hold the arm up on its plan. Real-time: yes.
[[nodiscard]] bool IsHeldUp(const WayToGoal& way) noexcept;

// True if limits have stopped the law short of the goal for servo.unreachable_s, and all plans were asked
// for in vain or the planner does not answer. The law may then stand so near to its goal that its error tells
// nothing. Real-time: yes.
[[nodiscard]] bool HasNoWay(const config::LawConfig& config, const WayToGoal& way) noexcept;

// True if a plan is under way, awaited, or may still be asked for: then limits that stop the law do not make
// the goal unreachable yet. False while the planner does not answer. Real-time: yes.
[[nodiscard]] bool MayFindAWay(const config::ServoConfig& config, const WayToGoal& way) noexcept;

// True if the last plan's end, `q_end`, is a good posture for a target at `p_BO` [m]. Real-time: yes.
[[nodiscard]] bool KeepsPosture(const WayToGoal& way, const model::Vec3& p_BO) noexcept;

// True if a plan for a target at one of these poses, in the same frame, suits the other too. Real-time: yes.
[[nodiscard]] bool IsSamePlace(const model::Pose& a, const model::Pose& b) noexcept;

// True if the target is not where `plan` takes it to be. Real-time: yes.
[[nodiscard]] bool IsElsewhere(const config::ServoConfig& config, const WaySight& sight,
                               const trajectory::Plan& plan) noexcept;

// True if the target is faster than 0.05 m/s, a turn of 1 rad/s counted as 0.1 m/s: then the law alone
// follows it. Real-time: yes.
[[nodiscard]] bool IsMoving(const config::ServoConfig& config, const WaySight& sight) noexcept;

// Asks the planner from this tick's reference. Real-time: yes.
void Ask(const WaySight& sight, WayToGoal& way) noexcept;

// The limits that can block a path. All others only slow the motion down.
inline constexpr hal::LimitSet kBarriers =
    hal::Bit(hal::Limit::kJointPosition) | hal::Bit(hal::Limit::kWorkspace) |
    hal::Bit(hal::Limit::kObstacle) | hal::Bit(hal::Limit::kSingularity) | hal::Bit(hal::Limit::kFieldOfView);

}  // namespace fovea::control
