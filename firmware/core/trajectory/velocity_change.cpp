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

VelocityPath::VelocityPath(const VelocityChange& change) noexcept : phases_(change.phases) {
  AxisState state = change.start;
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    begins_[i] = state;
    state = After(state, phases_[i].jerk, phases_[i].duration_s);
  }
  end_ = {state.x, change.v_end, 0.0};
}

AxisState VelocityPath::At(double t) const noexcept {
  double left = std::max(t, 0.0);
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    if (left <= phases_[i].duration_s) {
      return After(begins_[i], phases_[i].jerk, left);
    }
    left -= phases_[i].duration_s;
  }
  return {end_.x + left * end_.v, end_.v, 0.0};
}

VelocityChange PlanVelocityChange(double v0, double a0, double v1, const AxisLimits& limits) noexcept {
  const double jerk = limits.j_max;
  const AxisState start{0.0, v0, a0};
  AxisState state = start;
  JerkPhase back{0.0, 0.0};
  if (std::fabs(a0) > limits.a_max) {
    back = {(std::fabs(a0) - limits.a_max) / jerk, std::copysign(jerk, -a0)};
    state = After(state, back.jerk, back.duration_s);
    state.a = std::copysign(limits.a_max, a0);
  }
  // Up, unless releasing the acceleration alone would already lead beyond v1.
  const double direction = SettledVelocity(state.v, state.a, jerk) > v1 ? -1.0 : 1.0;
  const double gain = direction * (v1 - state.v);
  const double a = direction * state.a;
  // Velocity gained by a peak: (2 peak^2 - a^2) / (2 jerk) + peak hold = gain.
  double peak = std::sqrt(std::max(jerk * gain + 0.5 * a * a, 0.0));
  double hold_s = 0.0;
  if (peak > limits.a_max) {
    peak = limits.a_max;
    hold_s = std::max((gain + (a * a - 2.0 * peak * peak) / (2.0 * jerk)) / peak, 0.0);
  }
  const JerkPhase ramp{std::max((peak - a) / jerk, 0.0), direction * jerk};
  const JerkPhase hold{hold_s, 0.0};
  const JerkPhase release{peak / jerk, -direction * jerk};
  return {{back, ramp, hold, release}, start, v1, direction};
}

}  // namespace fovea::trajectory
