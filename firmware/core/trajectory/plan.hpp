// SPDX-License-Identifier: Apache-2.0
// A planned motion of all joints, from their reference to rest at a posture that reaches the goal.
//
// The planner (firmware/planning) makes it on a thread beside the tick. It is plain data without pointers, so
// that it can pass through a mailbox, a log and a board's line.
//
// The motion is a uniform cubic B-spline in time: with control points c_0 ... c_(n-1), one every `period_s`,
//
//   q(t) = sum b_k(x) c_(i+k), k = 0 ... 3,   i = floor(t / period_s),  x = t / period_s - i
//
// q, dq and ddq are continuous. Velocity, acceleration and jerk are weighted means of the first, second and
// third differences of the control points (divided by the period, its square, its cube). So a limit that
// these differences keep is kept at all times. (de Boor, A Practical Guide to Splines, 1978.)
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::trajectory {

enum class PlanOutcome : std::uint8_t {
  kFound,
  kBadRequest,
  kNotPlanned,
  kStartMoves,
  kStartNotClear,
  kTargetNotInSight,
  kNoGoalPosture,
  kGoalNotClear,
  kNoPath,
  kNotProved,
};
inline constexpr std::array<const char*, 10> kPlanOutcomeWords{
    "a motion to the goal was found",
    "the request holds a number that is not finite, or has the wrong number of joints",
    "this feature, or an arm with fewer than six joints, leaves the goal's posture to the visual law",
    "the arm moves at the start: a plan begins at rest, where its stop ends",
    "at the start the arm is past a limit",
    "at the start the target is out of the picture, or a flat target's painted side cannot be seen",
    "no posture was found that reaches the goal inside the joints' ranges",
    "every posture found that reaches the goal is past a limit",
    "no path to a goal was found that keeps all limits and the target in view",
    "a path was found, but no motion along it from which the arm can always stop inside all limits"};

// All of a plan except its control points.
struct PlanHead {
  static constexpr int kMostNumbers = 1800;
  static constexpr int kLeastPoints = 4;
  static constexpr int kMostPoints = 300;
  static constexpr int kMostTurns = 4;             // a square's
  static constexpr double kMostDuration = 3600.0;  // [s]

  PlanOutcome outcome = PlanOutcome::kNoPath;
  hal::Limit blocker = hal::Limit::kWorkspace;  // of kStartNotClear and kGoalNotClear: the limit
  std::int32_t num_joints = 0;
  std::int32_t num_points = 0;   // of control points; 0 unless found
  std::int32_t turn = 0;         // equal turn of the target about its z with which the goal is reached
  std::int64_t stamp_ns = 0;     // of the estimate that it was planned for
  double period_s = 0.0;         // between control points
  std::array<double, 3> p_BO{};  // the target's pose that it was planned for [m]
  std::array<double, 4> q_BO{1.0, 0.0, 0.0, 0.0};  // (w, x, y, z)

  [[nodiscard]] bool IsFound() const noexcept { return outcome == PlanOutcome::kFound; }
  // The number of control points that fit for an arm with `joints` joints, at least 1.
  [[nodiscard]] static constexpr int Capacity(int joints) noexcept {
    return joints * kMostPoints <= kMostNumbers ? kMostPoints : kMostNumbers / joints;
  }
  // Whether sizes and numbers are such that they can be used. Real-time: yes.
  [[nodiscard]] bool IsHeadSound() const noexcept;
  [[nodiscard]] int NumNumbers() const noexcept { return num_points * num_joints; }
  [[nodiscard]] double Duration() const noexcept {
    return static_cast<double>(num_points - kLeastPoints + 1) * period_s;
  }
};

struct Plan : PlanHead {
  std::array<double, kMostNumbers> points{};  // control points one after another, num_joints each [rad, m]

  // As IsHeadSound, control points included: At() can be called if it is also found.
  [[nodiscard]] bool IsSound() const noexcept;

  // The reference `t` seconds after the start: the first state before, rest at the goal from Duration() on.
  // `reference` becomes [num_joints]. Only for a sound plan that was found. Real-time: yes.
  void At(double t, Reference& reference) const noexcept;

  // Coordinate of control point `i` for joint `j`.
  [[nodiscard]] double Point(int i, int j) const noexcept {
    return points[static_cast<std::size_t>(i * num_joints + j)];
  }
};

static_assert(std::is_trivially_copyable_v<Plan> && sizeof(Plan) <= 16 * 1024, "a message");

}  // namespace fovea::trajectory
