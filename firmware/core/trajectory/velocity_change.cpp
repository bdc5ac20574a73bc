// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/velocity_change.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::trajectory {

double VelocityChange::Duration() const noexcept {
  return (phases[kReturn].duration_s + phases[kRamp].duration_s) +
         (phases[kHold].duration_s + phases[kRelease].duration_s);
}

AxisState VelocityChange::At(double t) const noexcept {
  AxisState state = start;
  double left = std::max(t, 0.0);
  for (const JerkPhase& phase : phases) {
    if (left <= phase.duration_s) {
      return After(state, phase.jerk, left);
    }
    state = After(state, phase.jerk, phase.duration_s);
    left -= phase.duration_s;
  }
  return {state.x + left * v_end, v_end, 0.0};
}

double VelocityChange::Travel() const noexcept {
  AxisState state = start;
  for (const JerkPhase& phase : phases) {
    state = After(state, phase.jerk, phase.duration_s);
  }
  return state.x;
}

VelocityChange PlanVelocityChange(double v0, double a0, double v1, const AxisLimits& limits) noexcept {
  const double jerk = limits.j_max;
  VelocityChange change;
  change.start = {0.0, v0, a0};
  change.v_end = v1;
  AxisState state = change.start;
  if (std::fabs(a0) > limits.a_max) {
    change.phases[VelocityChange::kReturn] = {(std::fabs(a0) - limits.a_max) / jerk,
                                              std::copysign(jerk, -a0)};
    state = After(state, std::copysign(jerk, -a0), (std::fabs(a0) - limits.a_max) / jerk);
    state.a = std::copysign(limits.a_max, a0);
  }
  // Up, unless releasing the acceleration alone would already lead beyond v1.
  change.direction = SettledVelocity(state.v, state.a, jerk) > v1 ? -1.0 : 1.0;
  const double gain = change.direction * (v1 - state.v);
  const double a = change.direction * state.a;
  // Velocity gained by a peak: (2 peak^2 - a^2) / (2 jerk) + peak hold = gain.
  double peak = std::sqrt(std::max(jerk * gain + 0.5 * a * a, 0.0));
  double hold_s = 0.0;
  if (peak > limits.a_max) {
    peak = limits.a_max;
    hold_s = std::max((gain + (a * a - 2.0 * peak * peak) / (2.0 * jerk)) / peak, 0.0);
  }
  change.phases[VelocityChange::kRamp] = {std::max((peak - a) / jerk, 0.0), change.direction * jerk};
  change.phases[VelocityChange::kHold] = {hold_s, 0.0};
  change.phases[VelocityChange::kRelease] = {peak / jerk, -change.direction * jerk};
  return change;
}

}  // namespace fovea::trajectory
