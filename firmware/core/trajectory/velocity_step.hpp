// One tick of an axis on its way to a velocity that may change with every tick: what limits the visual law,
// and brings the arm to rest in Hold.
//
// It is the time-optimal change of velocity_change.hpp on the grid of the ticks. There the acceleration of a
// tick is what the motion law is told, so it is constant in each: v grows by a T, and x by v T. The largest
// acceleration from which it can still return to zero, a jerk step at a time, before the velocity is reached,
// is a = sqrt(h^2 + 2 j |dv| / T) - h with j the jerk step and h = j / 2.
#pragma once

#include "firmware/core/trajectory/velocity_change.hpp"

namespace fovea::trajectory {

struct VelocityStep {
  AxisState state;        // after the tick
  bool at_a_max = false;  // the limit acted
  bool at_j_max = false;
};

// From `state` towards the velocity `v`, which itself goes on to change by `a`, in one tick of `period_s`.
// `limits.v_max` plays no part. Real-time: yes.
[[nodiscard]] VelocityStep StepVelocity(const AxisState& state, double v, double a, const AxisLimits& limits,
                                        double period_s) noexcept;

}  // namespace fovea::trajectory
