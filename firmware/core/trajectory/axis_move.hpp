// SPDX-License-Identifier: Apache-2.0
// Moves one axis from any position, velocity and acceleration to rest at a goal, within limits of velocity,
// acceleration and jerk: as fast as possible, or in a longer given time.
//
// The fastest move. An axis that stops as fast as possible rests at one place; "forward" is the direction
// from there to the goal. The fastest move accelerates forward for a time s (jerk, then the acceleration held
// at its limit) and stops from there. The place of rest grows with s, so that s is the only root of a
// monotone function. If s would exceed the velocity limit, the axis cruises at that limit. This needs no
// table of profiles. It also holds if the axis already brakes and only needs to brake a little less, so that
// its acceleration never becomes zero on the way. It is the time optimum for every start within the limits:
// no motion within them is anywhere faster than the rise to v_max or, backwards from the goal, the stop.
//
// A start beyond the limits is first brought back: the acceleration by full jerk, then the velocity by the
// shortest change towards +-v_max. Then the above applies.
//
// A longer duration. The axis changes to a cruise velocity and from there to rest. The duration grows without
// bound as that velocity goes to zero. If an axis brakes towards a goal close behind its stopping place,
// there is a gap between the fastest move and the fastest of these. In the gap the axis brakes for a time b,
// from zero to the whole stop, and then moves as fast as possible. So every longer duration is possible.
//
// Terms and problem: Kroeger and Wahl, Online trajectory generation, IEEE T-RO 26, 2010; Berscheid and
// Kroeger, Jerk-limited real-time trajectory generation with arbitrary target states, RSS 2021.
#pragma once

#include <array>

#include "firmware/core/trajectory/velocity_change.hpp"

namespace fovea::trajectory {

struct AxisMove {
  struct Phase {
    double start_s = 0.0;
    double duration_s = 0.0;
    double jerk = 0.0;
    AxisState start;
  };
  // Return to the limits (4), brake (4), wait, change (4), cruise, change (4), rest; most are usually absent.
  static constexpr int kMaxPhases = 19;

  // The last phase is the rest at the goal. Computed forward from the start and, for the last change of
  // velocity, backward from the goal, so that both ends are exact and rounding errors are in between.
  std::array<Phase, kMaxPhases> phases;
  int num_phases = 0;
  double duration_s = 0.0;
  double goal_x = 0.0;

  [[nodiscard]] double Duration() const noexcept { return duration_s; }
  // The state `t` seconds after the start; the start itself before that, and exact rest at the goal from the
  // end on. Real-time: yes.
  [[nodiscard]] AxisState At(double t) const noexcept;
};

// The move from `start` to rest at `goal_x` that lasts `duration_s`, or the shortest one if that is longer.
// `start` and `goal_x` are finite, `limits` finite and greater than zero. An axis at rest at its goal stays.
// Real-time: yes, about 1 us (some ten velocity changes; their square in the gap named above).
[[nodiscard]] AxisMove PlanAxisMove(const AxisState& start, double goal_x, const AxisLimits& limits,
                                    double duration_s = 0.0) noexcept;

}  // namespace fovea::trajectory
