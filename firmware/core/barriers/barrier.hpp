// SPDX-License-Identifier: Apache-2.0
// A barrier: a quantity h(q) that must stay above its margin and may approach it only at a limited speed.
//
// Everything that the motion avoids has this form: the workspace's edge, planes and boxes, the arm itself, a
// singular posture, the picture's edge, a line of sight, a disc's tilt. One file computes h and dh/dq of
// each. The resolution keeps it as a row, dh/dq . dq + drift >= -(largest speed). For everything that the arm
// can collide with, the guard also proves that a stop stays clear of it (solid_barriers.hpp).
#pragma once

#include <cmath>

#include "firmware/core/model/types.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::barriers {

struct Barrier {
  hal::Limit name = hal::Limit::kWorkspace;
  double value = HUGE_VAL;  // h; HUGE_VAL: the barrier is inactive
  model::VecN gradient;     // [num_joints] dh/dq
  double margin = 0.0;      // lower bound of h
  double drift = 0.0;       // dh/dt from the target's motion alone

  // How fast h - margin may shrink: like exp(-rate t) at most [1/s]. If rate is 0: at the speed from which a
  // stop with `deceleration` [unit of h per s^2] after `reaction_s` [s] still keeps the margin.
  double rate = 0.0;
  double deceleration = 0.0;
  double reaction_s = 0.0;
  // An h below its margin returns with `return_rate` [1/s], at most at `return_speed` [unit of h per s].
  double return_rate = 0.0;
  double return_speed = 0.0;

  // The largest -dh/dt that the arm's own motion may cause [unit of h per s]. It is negative, which forbids
  // standing still, only while h returns. Real-time: yes.
  [[nodiscard]] double SpeedMost() const noexcept;
};

}  // namespace fovea::barriers
