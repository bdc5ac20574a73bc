// How a reference comes to rest when every joint brakes as hard as it may, and where that leads.
//
// Each joint's velocity goes to zero in the shortest time that its acceleration and jerk limits allow: jerk,
// constant deceleration, jerk. The joints stop at different times, so the end effector's way is none that was
// planned; it is looked at point by point.
#pragma once

#include <array>

#include "fovea/hal/events.hpp"
#include "fovea/model/types.hpp"
#include "fovea/servo/reference.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// One joint's way to rest: acceleration a_0 to -a_peak to 0 (for sign = +1), with the jerk `jerk`.
struct JointStop {
  double sign = 1.0;
  double jerk = 1.0;
  double a_peak = 0.0;
  double ramp_s = 0.0;     // until the peak is reached
  double hold_s = 0.0;     // at the peak
  double release_s = 0.0;  // back to zero
  [[nodiscard]] double Duration() const noexcept { return ramp_s + hold_s + release_s; }
};

// The shortest stop from velocity `dq` and acceleration `ddq` within `ddq_max` and `dddq_max`.
// Real-time: yes.
[[nodiscard]] JointStop PlanStop(double dq, double ddq, double ddq_max, double dddq_max) noexcept;

// How far the joint goes until `t` seconds into the stop. Real-time: yes.
[[nodiscard]] double StopTravel(const JointStop& stop, double dq, double ddq, double t) noexcept;

// The limits that a stop from `reference` would pass: the joints' range, the workspace, an obstacle, each
// with its margin; 0 when it stays clear of all. What is already past one may only come back. `p_now` is p_BE
// of the reference before [m], and `q_now` its joints. Real-time: yes, at most kStopSamples poses.
inline constexpr int kStopSamples = 12;
[[nodiscard]] hal::LimitSet LimitsPassed(const ServoConfig& config, const Reference& reference,
                                         const model::VecN& q_now, const model::Vec3& p_now) noexcept;

}  // namespace fovea::servo
