// A quantity h(q) that may come down to its margin only so fast, and no further.
//
// Everything that the motion keeps away from has this form: the workspace's edge, planes and boxes, the arm
// itself, a singular posture, the picture's edge, a line of sight, a disc's tilt. Each has its geometry in
// one place, which gives h and dh/dq; the resolution keeps it as a row, dh/dq . dq + drift >= -(largest
// speed), and what the arm can run into is also what a stop is proved before (solid_barriers.hpp).
#pragma once

#include <cmath>

#include "firmware/core/model/types.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::barriers {

struct Barrier {
  hal::Limit name = hal::Limit::kWorkspace;
  double value = HUGE_VAL;  // h; HUGE_VAL: there is nothing to keep
  model::VecN gradient;     // [num_joints] dh/dq
  double margin = 0.0;      // h shall not go below it
  double drift = 0.0;       // dh/dt without any motion of the arm, as the target moves

  // How what is left, h - margin, may be used up: no faster than exp(-rate t) [1/s]; or, where the rate is 0,
  // as fast as it can be stopped with `deceleration` [of h, per s^2] after `reaction_s` [s].
  double rate = 0.0;
  double deceleration = 0.0;
  double reaction_s = 0.0;
  // What is past its margin goes back: with this rate [1/s], but no faster than this [of h, per s].
  double return_rate = 0.0;
  double return_speed = 0.0;

  // The largest speed -dh/dt that the arm may bring it nearer with [of h, per s]. Standing still is always
  // allowed but where it shall go back. Real-time: yes.
  [[nodiscard]] double SpeedMost() const noexcept;
};

}  // namespace fovea::barriers
