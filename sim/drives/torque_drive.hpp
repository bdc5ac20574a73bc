// SPDX-License-Identifier: Apache-2.0
// A joint's drive: what becomes of a torque command until it acts on the joint.
//
// In this order: rounding to the converter's steps, a pure delay, a first-order lag (the current loop's
// bandwidth), and the motor's torque ripple. A command is constant over a tick, so the lag is solved exactly,
// also where a delay is not a whole number of ticks. A step returns the torque's mean over the tick, which
// gives the physics the right impulse.
#pragma once

#include <array>
#include <cstddef>

#include "fovea/hal/types.hpp"

namespace fovea::sim {

inline constexpr int kMostDelayTicks = 50;

struct TorqueDriveConfig {
  double bandwidth_hz = 0.0;   // the lag's corner frequency; 0: no lag
  double delay_s = 0.0;        // 0 to kMostDelayTicks ticks
  double quantum = 0.0;        // step of the command [Nm, N]; 0: no rounding
  double ripple = 0.0;         // amplitude [Nm, N]
  double ripple_cycles = 0.0;  // periods of the ripple per turn of the joint; per 2 pi m if it slides
  double ripple_phase = 0.0;   // of the ripple at q = 0 [rad]
};

class TorqueDrive {
 public:
  explicit TorqueDrive(const TorqueDriveConfig& config);

  // As if `tau` [Nm, N] had been commanded for ever. Returns what then acts, without ripple.
  double Settle(double tau);

  // Advances by one tick under the command `tau` [Nm, N]. `q` [rad, m] and `dq`: the joint's motion at the
  // tick's beginning. Returns the mean torque over the tick.
  double Step(double tau, double q, double dq);

 private:
  // Lets `input` act on the lag for `time_s`. Returns the integral of the output [Nm s, N s].
  double Lag(double input, double time_s);
  [[nodiscard]] double Ripple(double q, double dq) const;
  // The command of `ticks` ticks ago.
  [[nodiscard]] double Past(std::size_t ticks) const;

  TorqueDriveConfig config_;
  std::size_t whole_ticks_;                             // of the delay
  double rest_s_;                                       // of the delay, below one tick
  std::array<double, kMostDelayTicks + 2> commands_{};  // a ring
  std::size_t newest_ = 0;
  double output_ = 0.0;  // of the lag
};

}  // namespace fovea::sim
