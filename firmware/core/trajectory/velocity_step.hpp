// SPDX-License-Identifier: Apache-2.0
// One tick of an axis towards a velocity that may change with every tick. It limits the visual law's motion,
// and brings the arm to rest in Hold.
//
// It is the time-optimal change of velocity_change.hpp on the grid of the ticks. The motion law gets one
// acceleration per tick, which is constant in it: v grows by a T, and x by v T. The largest acceleration that
// can still return to zero, one jerk step at a time, before the velocity is reached is a = sqrt(h^2 + 2 j
// |dv| / T) - h with j the jerk step and h = j / 2.
#pragma once

#include "firmware/core/trajectory/velocity_change.hpp"

namespace fovea::trajectory {

struct VelocityStep {
  AxisState state;        // after the tick
  bool at_a_max = false;  // the limit acted
  bool at_j_max = false;
  bool reaches = false;  // the velocity, in this tick
};

// One tick of `period_s` from `state` towards the velocity `v`, which itself changes by `a`. `limits.v_max`
// is not used. Real-time: yes.
[[nodiscard]] VelocityStep StepVelocity(const AxisState& state, double v, double a, const AxisLimits& limits,
                                        double period_s) noexcept;

}  // namespace fovea::trajectory
