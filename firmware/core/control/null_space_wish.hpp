// What the arm would do with the freedom that the task leaves it: a sum of wished joint velocities, each with
// its own gain, bounded as a whole. None of them disturbs a task that is free to move; where a limit holds
// the arm back, wish and task compete for what is left, and the bound keeps the wish the weaker one.
//
//   posture         gain (q_posture - q)
//   joint limits    -gain dP/dq, a potential P that is zero in the middle of the range and rises from `onset`
//                   (share of the half range) on; quadratic slope, so that the wish sets in smoothly, and
//                   bounded also past the range's end. It does not act in the middle on purpose: there the
//                   posture pulls, and two pulls to different places would settle between them.
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
  double length = 0.3;                // that a metre counts as much as a radian for [m]
  double speed_max = 0.1;             // |wish| stays below this, smoothly [rad/s]; > 0
};

// The potential's slope [rad], [num_joints], at `q`, without gain: -dP/dq. At most (1 - onset) half ranges.
// A joint whose range is empty wishes nothing. Real-time: yes.
[[nodiscard]] model::VecN JointLimitWish(const model::ArmModel& arm, const model::VecN& q,
                                         double onset) noexcept;

// dm/dq [1/rad], [num_joints], for the body Jacobian `J` [6 x num_joints] of any frame fixed to the end
// effector. With soft = 0 not bounded, and NaN at a singularity. Real-time: yes.
[[nodiscard]] model::VecN ManipulabilityGradient(const model::Mat6N& J, double length, double soft) noexcept;

// The sum s, bounded: s speed_max / sqrt(speed_max^2 + |s|^2). A wish with gain 0 costs nothing. Real-time:
// yes.
[[nodiscard]] model::VecN NullSpaceWish(const NullSpaceConfig& config, const model::ArmModel& arm,
                                        const model::VecN& q, const model::Mat6N& J) noexcept;

}  // namespace fovea::control
