// SPDX-License-Identifier: Apache-2.0
// The secondary task for the directions that the task leaves free: a sum of wished joint velocities, each
// with its own gain, bounded as a whole. It does not disturb the task while no limit acts. When a limit acts,
// both compete for the remaining freedom, and the bound keeps the wish the weaker one.
//
//   posture         gain (q_posture - q)
//   joint limits    -gain dP/dq with a potential P that is zero in the middle of the range and rises from
//                   `onset` (share of the half range) on. Its slope is quadratic, so that the wish starts
//                   smoothly, and bounded beyond the range's end. In the middle only the posture pulls: two
//                   pulls to different places would settle between them.
//   manipulability  gain dm/dq,  m = 1/2 log det(J J^T + soft^2 I): the logarithm of the manipulability
//                   sqrt(det J J^T) (Yoshikawa, 1985), softened so that the wish stays bounded at a
//                   singularity. J is the body Jacobian with its linear rows divided by `length`.
#pragma once

#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

struct NullSpaceConfig {
  double posture_gain = 0.6;          // [1/s]
  hal::JointArray q_posture{};        // [rad]
  double joint_limit_gain = 2.0;      // [1/s]
  double joint_limit_onset = 0.8;     // share of the half range, 0 to 1 (excluded)
  double manipulability_gain = 0.05;  // [rad^2/s]
  double manipulability_soft = 0.05;  // singular values below this count little; > 0
  double length = 0.3;                // this distance counts as much as one radian [m]
  double speed_max = 0.1;             // |wish| stays below this, smoothly [rad/s]; > 0
};

// -dP/dq [rad], [num_joints], at `q`, without gain. At most (1 - onset) half ranges; 0 for a joint with an
// empty range. Real-time: yes.
[[nodiscard]] model::VecN JointLimitWish(const model::ArmModel& arm, const model::VecN& q,
                                         double onset) noexcept;

// dm/dq [1/rad], [num_joints], for the body Jacobian `J` [6 x num_joints] of any frame fixed to the end
// effector. With soft = 0 it is unbounded, and NaN at a singularity. Real-time: yes.
[[nodiscard]] model::VecN ManipulabilityGradient(const model::Mat6N& J, double length, double soft) noexcept;

// The sum s, bounded: s speed_max / sqrt(speed_max^2 + |s|^2). A wish with gain 0 takes no time.
// Real-time: yes.
[[nodiscard]] model::VecN NullSpaceWish(const NullSpaceConfig& config, const model::ArmModel& arm,
                                        const model::VecN& q, const model::Mat6N& J) noexcept;

}  // namespace fovea::control
