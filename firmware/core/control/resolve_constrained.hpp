// Kinematic resolution with all limits inside: one constrained problem per tick.
//
// The wish is the damped solution without limits (resolve_damped.hpp). Of all joint velocities that keep the
// limits, the one is taken that departs least from it, where a departure d costs
//
//   |J d|^2 off the task's course + progress_weight |J d|^2 along it + null_weight^2 |d|^2_W
//
// in this order of size, and not from the wish as it is: what dq_0 adds to it is brought inside the limits
// first, beside a task at rest that counts 1 / free_weight^2 times as much. So while the joints can still do
// it together, the task is kept (to some null_weight^2) and the null space pays for the limits; when they no
// longer can, the task slows down rather than leave its course; and it leaves it, to slide along a boundary,
// when it could not go on otherwise. The weights stand in for a strict order of priorities, under which the
// result would jump. A wish dq_0 that pulls against a limit keeps the task off its goal by about
// free_weight^2 |dq_0|, which is nothing.
#pragma once

#include "firmware/core/control/move_into_limits.hpp"
#include "firmware/core/control/resolve_damped.hpp"

namespace fovea::control {

struct ConstrainedConfig {
  DampingConfig damping;
  double progress_weight = 0.3;  // 1: slide freely along a boundary; towards 0: keep the direction, > 0
  double null_weight = 0.02;     // of the null space, relative to the rms singular value of J W^-1/2, > 0
  double free_weight = 4e-4;     // of the wish dq_0 beside the task, the same way, > 0
};

struct ConstrainedMotion {
  DampedMotion wish;
  LimitedMotion limited;    // its dq is the result
  double task_share = 1.0;  // of the wish's task velocity, projected on it; 1 when it has none
};

// When the wish is not finite, `limited` says so and is as near to rest as the joints' ranges allow.
// Real-time: yes.
void ResolveConstrained(const ConstrainedConfig& config, const MotionTask& task,
                        const barriers::MotionLimits& limits, ConstrainedMotion& motion) noexcept;

}  // namespace fovea::control
