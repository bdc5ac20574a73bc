// SPDX-License-Identifier: Apache-2.0
// Stage 3, guard: converts any wish for joint velocities to a reference that the arm may follow.
//
// First it shapes the wish so that it approaches each limit softly: joint velocity, joint position,
// workspace. A barrier allows only speeds that can still be stopped before it (THEORY B5): with distance d,
// deceleration a, and T the delay of a tick and the jerk limit, v <= a (sqrt(T^2 + 2 d / a) - T). Then it
// limits acceleration and jerk. Finally it proves the stop: it accepts the new reference only if the arm, at
// full braking from there, stops inside every limit (stop_path.hpp). Otherwise it reduces the wish, down to
// braking if necessary. Braking is always safe, because the previous tick proved it. So no wish, and no
// combination of limits, leads across a boundary.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

// The wished joint velocities and their rate of change. Finite.
struct MotionWish {
  model::VecN dq;      // [num_joints]
  model::VecN ddq;     // [num_joints]
  bool stops = false;  // it leads to rest; if a limit acts, each joint brakes by itself at full braking

  // A constant velocity.
  static MotionWish Velocity(const model::VecN& dq) noexcept {
    MotionWish wish;
    wish.dq = dq;
    wish.ddq.setZero(dq.size());
    return wish;
  }
};

// The wish that brings `reference` to rest with all joints in step: each slows down in the same proportion as
// the one that takes longest, so that the hand stays on its course and slows down all the way. (At full
// braking the joints would stop one after the other. The last one would then throw a hand that was at rest
// between two fast joints.) Real-time: yes.
[[nodiscard]] MotionWish StopTogether(const config::ServoConfig& config,
                                      const trajectory::Reference& reference) noexcept;

// Advances `reference` by one tick towards `wish`. `p_BE` [m]: the end effector's position. `J_E_B` [3 x
// num_joints]: its linear Jacobian in axes of B. `known`: as for LimitsPassed. Returns the limits that acted.
// Real-time: yes.
hal::LimitSet GuardMotion(const config::ServoConfig& config, const MotionWish& wish, const model::Vec3& p_BE,
                          const model::LinearJacobian& J_E_B, KnownClearances& known,
                          trajectory::Reference& reference) noexcept;

}  // namespace fovea::guard
