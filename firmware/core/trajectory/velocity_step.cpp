// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/velocity_step.hpp"

#include <cmath>

namespace fovea::trajectory {

VelocityStep StepVelocity(const AxisState& state, double v, double a, const AxisLimits& limits,
                          double period_s) noexcept {
  const double jerk_step = limits.j_max * period_s;
  const double half = 0.5 * jerk_step;
  double beside = (v - state.v) / period_s - a;  // the acceleration beside `a` that reaches v in this tick
  const double most = std::sqrt(half * half + 2.0 * jerk_step * std::fabs(beside)) - half;
  bool at_a_max = false;
  bool at_j_max = false;
  bool reaches = true;
  if (std::fabs(beside) > most) {
    beside = std::copysign(most, beside);
    reaches = false;
  }
  double next = a + beside;
  if (std::fabs(next) > limits.a_max) {
    next = std::copysign(limits.a_max, next);
    at_a_max = true;
    reaches = false;
  }
  if (const double change = next - state.a; std::fabs(change) > jerk_step) {
    next = state.a + std::copysign(jerk_step, change);
    at_j_max = true;
    reaches = false;
  }
  const double v_next = state.v + next * period_s;
  return {{state.x + v_next * period_s, v_next, next}, at_a_max, at_j_max, reaches};
}

}  // namespace fovea::trajectory
