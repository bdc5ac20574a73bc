// Stage 3, guard: turns any wish for joint velocities into a reference that the arm may follow.
//
// First the wish is shaped, so that it meets each limit softly: joint velocity, joint position, workspace. A
// barrier lets through only what can still be stopped before it (THEORY B5): with distance d, deceleration a
// and T the time that a tick and the jerk limit cost,  v <= a (sqrt(T^2 + 2 d / a) - T).
// Then acceleration and jerk. At last the proof: the new reference is taken only if the arm, braking from it
// as hard as it may, would stop inside every limit (stop_path.hpp). Else the wish is cut down, to braking if
// need be; and braking is always safe, since it is what was proved the tick before. So no wish, and no
// interplay of limits, leads across a boundary.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

// How the joints shall move, and how that goes on to change. Finite.
struct MotionWish {
  model::VecN dq;   // [num_joints]
  model::VecN ddq;  // [num_joints]
  bool stops =
      false;  // it leads to rest: where a limit acts, each joint brakes for itself, as hard as it may

  // A velocity to stay at, as far as anybody knows.
  static MotionWish Velocity(const model::VecN& dq) noexcept {
    MotionWish wish;
    wish.dq = dq;
    wish.ddq.setZero(dq.size());
    return wish;
  }
};

// To bring `reference` to rest with all joints in step: each is slowed in the same proportion as the one that
// takes longest, so that the hand stays on its course and gets slower all the way. (Each joint as hard as it
// may would stop them one after the other; a hand that rests between two fast joints would then be thrown by
// the one that is left.) Real-time: yes.
[[nodiscard]] MotionWish StopTogether(const config::ServoConfig& config,
                                      const trajectory::Reference& reference) noexcept;

// Moves `reference` on by one tick towards `wish`. `p_BE` [m] is where the end effector is, `J_E_B`
// [3 x num_joints] its linear Jacobian in axes of B, and `reference_poses` where `reference` has the links.
// Returns the limits that acted. Real-time: yes.
hal::LimitSet GuardMotion(const config::ServoConfig& config, const MotionWish& wish, const model::Vec3& p_BE,
                          const model::LinearJacobian& J_E_B, const model::ArmPoses& reference_poses,
                          trajectory::Reference& reference) noexcept;

}  // namespace fovea::guard
