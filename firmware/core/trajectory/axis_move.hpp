// One axis from any position, velocity and acceleration to rest at a goal, within limits of velocity,
// acceleration and jerk: as fast as it can, or so that it takes a longer time that is asked for.
//
// The fastest move. Let the axis stop as fast as it can: it comes to rest at one place, and towards the goal
// from there is "forward". The fastest way accelerates forward for a time s (jerk, then the acceleration held
// at its limit) and stops from there. Where it comes to rest grows with s, so s is the one root of a monotone
// function; where s would pass the velocity limit, the axis cruises at that limit. This needs no table of
// profiles: it holds as well when the axis is already braking and need only ease off a little, so that its
// acceleration never comes to zero on the way. It is the time optimum for every start within the limits: no
// motion within them is anywhere faster than the way to v_max and, backwards from the goal, than the stop.
//
// A start beyond the limits is first brought back: the acceleration by full jerk, then the velocity by the
// shortest change towards +-v_max. From there on the above.
//
// A longer duration. The axis changes to a cruise velocity and from there to rest; the duration grows beyond
// bounds as that velocity goes to zero. An axis that is braking towards a goal close behind its stopping
// place has a gap between the fastest move and the fastest of those: there the axis brakes for a time b and
// only then goes as fast as it can, b from zero to the whole stop. So every duration above the least can be
// had.
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
  // Return to the limits (4), brake (4), wait, change (4), cruise, change (4), rest; most of them are usually
  // none.
  static constexpr int kMaxPhases = 19;

  // The last phase is the rest at the goal. Computed forward from the start and, for the last change of
  // velocity, backward from the goal, so that both ends are exact and rounding shows between.
  std::array<Phase, kMaxPhases> phases;
  int num_phases = 0;
  double duration_s = 0.0;
  double goal_x = 0.0;

  [[nodiscard]] double Duration() const noexcept { return duration_s; }
  // The state `t` seconds after the start; the start itself before, and exactly rest at the goal from the end
  // on. Real-time: yes.
  [[nodiscard]] AxisState At(double t) const noexcept;
};

// The move from `start` to rest at `goal_x` that lasts `duration_s`, or as short as it can when that is
// longer. `start` and `goal_x` are finite, `limits` finite and greater than zero. An axis at rest at its goal
// stays. Real-time: yes, about 1 us (some ten velocity changes; their square in the gap named above).
[[nodiscard]] AxisMove PlanAxisMove(const AxisState& start, double goal_x, const AxisLimits& limits,
                                    double duration_s = 0.0) noexcept;

}  // namespace fovea::trajectory
