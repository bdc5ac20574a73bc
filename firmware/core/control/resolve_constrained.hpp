// SPDX-License-Identifier: Apache-2.0
// Kinematic resolution that includes all limits: one constrained problem per tick.
//
// The wish is the damped solution without limits (resolve_damped.hpp). The result is the joint velocity
// within the limits that departs least from the wish. A departure d costs
//
//   |J d|^2 off the task's course + progress_weight |J d|^2 along it + null_weight^2 |d|^2_W
//
// in this order of size. Before that, the part of the wish that comes from dq_0 is brought inside the limits
// on its own; there, keeping the task at rest counts 1 / free_weight^2 times as much. While the joints can do
// the task within the limits, the task is kept (to about null_weight^2) and the null space yields. If they
// cannot, the task slows down on its course. It leaves the course, to slide along a boundary, only if it
// would stop otherwise. The weights replace a strict order of priorities, which would make the result jump. A
// dq_0 that pulls against a limit keeps the task off its goal by only about free_weight^2 |dq_0|.
#pragma once

#include "firmware/core/control/move_into_limits.hpp"
#include "firmware/core/control/resolve_damped.hpp"

namespace fovea::control {

struct ConstrainedConfig {
  DampingConfig damping;
  double progress_weight = 0.3;  // 1: slide freely along a boundary; towards 0: keep the direction, > 0
  double null_weight = 0.02;     // of the null space, relative to the rms singular value of J W^-1/2, > 0
  double free_weight = 4e-4;     // of the wish dq_0, relative to the same value, > 0
};

struct ConstrainedMotion {
  DampedMotion wish;
  LimitedMotion limited;    // its dq is the result
  double task_share = 1.0;  // share of the wish's task velocity that remains, by projection; 1 if it is zero
};

// If the wish is not finite, `limited` reports it and is as near to rest as the joints' ranges allow.
// Real-time: yes.
void ResolveConstrained(const ConstrainedConfig& config, const MotionTask& task,
                        const barriers::MotionLimits& limits, ConstrainedMotion& motion) noexcept;

}  // namespace fovea::control
