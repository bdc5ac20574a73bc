// Stage 3, guard: turns any wish for joint velocities into a reference that the arm may follow.
//
// In this order: joint velocity, joint position barrier, workspace barrier, then acceleration and jerk. A
// barrier lets through only what can still be stopped before it (THEORY B5): with distance d, deceleration
// a and T the time that a tick and the jerk limit cost,  v <= a (sqrt(T^2 + 2 d / a) - T).
#pragma once

#include "fovea/hal/events.hpp"
#include "fovea/model/kinematics.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// The reference, which the motion law follows. Continuous in q, dq and ddq.
struct Reference {
  model::VecN q;
  model::VecN dq;
  model::VecN ddq;
};

// The fastest speed [m/s or rad/s] from which a stop within `distance` is possible, given the deceleration
// and the reaction time; 0 when the distance is used up. Real-time: yes.
[[nodiscard]] double BarrierSpeed(double distance, double deceleration, double reaction_s) noexcept;

// Moves `reference` on by one tick towards the velocity `dq_des`. `p_BE` [m] is where the end effector is,
// `J_E_B` [3 x num_joints] its linear Jacobian in axes of B. Returns the limits that acted.
// Real-time: yes.
hal::LimitSet GuardMotion(const ServoConfig& config, const model::VecN& dq_des, const model::Vec3& p_BE,
                          const model::LinearJacobian& J_E_B, Reference& reference) noexcept;

}  // namespace fovea::servo
