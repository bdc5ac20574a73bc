// SPDX-License-Identifier: Apache-2.0
// A million random moves of one axis keep their limits, arrive, and respect lower bounds of the duration.
#include "firmware/core/trajectory/axis_move.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::trajectory {
namespace {

struct Case {
  AxisLimits limits;
  AxisState start;
  double goal_x = 0.0;
  bool stops_there = false;  // the shortest stop ends at the goal, within rounding
};

double Decades(test::RandomStates& random, double low, double high) {
  return std::pow(10.0, random.Uniform(low, high));
}

double Sign(test::RandomStates& random) { return random.Uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0; }

// Starts: within the limits (four in ten), at rest, at constant velocity, at the limit, or up to four times
// beyond. Goals: over ten decades, at the start, at the end of the shortest stop, or near it.
Case Draw(test::RandomStates& random) {
  Case c;
  c.limits = {Decades(random, -3, 3), Decades(random, -3, 3), Decades(random, -3, 4)};
  c.start.x = random.Uniform(-1.0, 1.0) * Decades(random, -3, 1);
  const double start_kind = random.Uniform(0.0, 10.0);
  const double size = start_kind < 8.0 ? 1.0 : 4.0;
  if (start_kind > 2.0) {
    c.start.v = size * random.Uniform(-1.0, 1.0) * c.limits.v_max;
    c.start.a = size * random.Uniform(-1.0, 1.0) * c.limits.a_max;
    if (start_kind < 3.0) {
      c.start.a = 0.0;
    } else if (start_kind < 4.0) {
      c.start = {c.start.x, std::copysign(c.limits.v_max, c.start.v), 0.0};
    }
  }
  const VelocityChange stop = PlanVelocityChange(c.start.v, c.start.a, 0.0, c.limits);
  const double stop_x = c.start.x + stop.Travel();
  const double goal_kind = random.Uniform(0.0, 10.0);
  if (goal_kind < 1.0) {
    c.goal_x = c.start.x;
  } else if (goal_kind < 1.5) {
    c.goal_x = stop_x;
  } else if (goal_kind < 5.0) {
    c.goal_x = stop_x + Sign(random) * Decades(random, -6, 0) * std::fabs(stop_x - c.start.x);
  } else {
    c.goal_x = c.start.x + Sign(random) * Decades(random, -6, 4);
  }
  const double scale = std::fabs(c.start.x) + std::fabs(stop_x) + std::fabs(c.start.v) * stop.Duration();
  c.stops_there = std::fabs(c.goal_x - stop_x) <= 1e-14 * scale;
  return c;
}

// How long an axis may be beyond its limits: full jerk back to the acceleration limit, then the shortest
// change to the velocity limit [s].
double ReturnTime(const Case& c) {
  const double excess_s = std::max(std::fabs(c.start.a) - c.limits.a_max, 0.0) / c.limits.j_max;
  const AxisState in = After(c.start, std::copysign(c.limits.j_max, -c.start.a), excess_s);
  const double v = SettledVelocity(in.v, in.a, c.limits.j_max);
  if (std::fabs(v) > c.limits.v_max) {
    return excess_s + PlanVelocityChange(in.v, in.a, std::copysign(c.limits.v_max, v), c.limits).Duration();
  }
  return std::fabs(in.v) > c.limits.v_max ? excess_s + std::fabs(in.a) / c.limits.j_max : excess_s;
}

// The worst of all moves: errors relative to the size of the quantity, and shares used of the limits.
struct Residuals {
  double seam_x = 0.0, seam_v = 0.0, seam_a = 0.0;
  double use_v = 0.0, use_a = 0.0, use_j = 0.0;
  double way = 0.0;      // between two samples, against their velocities
  double arrival = 0.0;  // of the duration, relative to the one asked for
};

void Worse(double& worst, double value) { worst = std::max(worst, std::isnan(value) ? 1e300 : value); }

// The length to which rounding errors are compared.
double WayGone(const Case& c, const AxisMove& move) {
  double way = std::fabs(c.start.x) + std::fabs(c.goal_x);
  for (int k = 0; k < move.num_phases; ++k) {
    const AxisMove::Phase& phase = move.phases[static_cast<std::size_t>(k)];
    way += std::fabs(phase.start.v) * phase.duration_s;
  }
  return way;
}

void CheckSeams(const Case& c, const AxisMove& move, Residuals& worst) {
  AxisState size{WayGone(c, move), 0.0, 0.0};
  for (int k = 0; k < move.num_phases; ++k) {
    const AxisMove::Phase& phase = move.phases[static_cast<std::size_t>(k)];
    size.v = std::max(size.v, std::fabs(phase.start.v));
    size.a = std::max(size.a, std::fabs(phase.start.a));
  }
  ASSERT_LE(move.num_phases, AxisMove::kMaxPhases);
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(move.num_phases); ++k) {
    const AxisMove::Phase& phase = move.phases[k];
    const AxisState end = After(phase.start, phase.jerk, phase.duration_s);
    const AxisState& next = move.phases[k + 1].start;
    Worse(worst.seam_x, std::fabs(end.x - next.x) / size.x);
    Worse(worst.seam_v, std::fabs(end.v - next.v) / size.v);
    Worse(worst.seam_a, std::fabs(end.a - next.a) / size.a);
    Worse(worst.use_j, std::fabs(phase.jerk) / c.limits.j_max);
    ASSERT_GT(phase.duration_s, 0.0);
  }
}

// Looks at the ends of the phases and at velocity extremes inside them. The move may be beyond the limits
// only until ReturnTime, and no further than the start forces it to be.
void CheckLimits(const Case& c, const AxisMove& move, Residuals& worst) {
  const double return_s = ReturnTime(c) * (1.0 + 1e-12);
  const double v_return = std::max({c.limits.v_max, std::fabs(c.start.v),
                                    std::fabs(SettledVelocity(c.start.v, c.start.a, c.limits.j_max))});
  const double a_return = std::max(c.limits.a_max, std::fabs(c.start.a));
  // A start far beyond the limits can lead to velocities whose last bit is more than all of v_max.
  double rounding = 0.0;
  for (int k = 0; k < move.num_phases; ++k) {
    rounding = std::max(rounding, 1e-14 * std::fabs(move.phases[static_cast<std::size_t>(k)].start.v));
  }
  const auto look = [&](const AxisMove::Phase& phase, double t) {
    const AxisState state = After(phase.start, phase.jerk, t);
    const bool is_back = phase.start_s + t >= return_s;
    Worse(worst.use_v, (std::fabs(state.v) - rounding) / (is_back ? c.limits.v_max : v_return));
    Worse(worst.use_a, std::fabs(state.a) / (is_back ? c.limits.a_max : a_return));
  };
  for (std::size_t k = 0; k < static_cast<std::size_t>(move.num_phases); ++k) {
    const AxisMove::Phase& phase = move.phases[k];
    look(phase, 0.0);
    look(phase, phase.duration_s);
    const double extreme = -phase.start.a / phase.jerk;
    if (phase.jerk != 0.0 && extreme > 0.0 && extreme < phase.duration_s) {
      look(phase, extreme);
    }
  }
}

// Checks At() at the start, at two random times a tick apart, and at the goal.
void CheckSamples(const Case& c, const AxisMove& move, test::RandomStates& random, Residuals& worst) {
  const double T = move.Duration();
  if (T > 0.0) {
    const AxisState first = move.At(0.0);
    ASSERT_TRUE(first.x == c.start.x && first.v == c.start.v && first.a == c.start.a);
    const double h = std::min(1e-3, 1e-2 * T);
    const double t = random.Uniform(0.0, T);
    const AxisState a = move.At(t);
    const AxisState b = move.At(t + h);
    const double return_s = ReturnTime(c) * (1.0 + 1e-12);
    // Times are rounded to their last bit, accelerations too.
    const double rounding = 8e-16 * (T * c.limits.j_max + std::fabs(a.a) + std::fabs(b.a)) / h;
    Worse(worst.use_j, (std::fabs(b.a - a.a) / h - rounding) / c.limits.j_max);
    // The error of the trapezoidal rule is at most jerk h^3 / 12.
    const double way = std::fabs(b.x - a.x - 0.5 * h * (a.v + b.v)) - c.limits.j_max * h * h * h / 12.0;
    Worse(worst.way, way / WayGone(c, move));
    if (t >= return_s) {
      const double v_rounding = 1e-14 * std::max(std::fabs(c.start.v), return_s * std::fabs(c.start.a));
      Worse(worst.use_v, (std::fabs(a.v) - v_rounding) / c.limits.v_max);
      Worse(worst.use_a, std::fabs(a.a) / c.limits.a_max);
    }
  }
  for (const double t : {T, T + 1e-9, 2.0 * T + 1.0}) {
    const AxisState last = move.At(t);
    ASSERT_TRUE(last.x == c.goal_x && last.v == 0.0 && last.a == 0.0);
  }
}

// Lower bounds of the duration that hold for any move.
void CheckDuration(const Case& c, const AxisMove& move) {
  const double T = move.Duration() * (1.0 + 1e-9);
  ASSERT_GE(T, PlanVelocityChange(c.start.v, c.start.a, 0.0, c.limits).Duration());
  if (std::fabs(c.start.v) <= c.limits.v_max && ReturnTime(c) == 0.0) {
    const double distance = std::fabs(c.goal_x - c.start.x);
    ASSERT_GE(T, distance / c.limits.v_max);
    if (c.start.v == 0.0 && c.start.a == 0.0) {
      ASSERT_GE(T, std::max(2.0 * std::sqrt(distance / c.limits.a_max),
                            std::cbrt(32.0 * distance / c.limits.j_max)));
    }
  }
}

TEST(AxisMovePropertyTest, MillionRandomMovesKeepTheirLimitsAndArrive) {
  test::RandomStates random(64);
  Residuals worst;
  int waited = 0;
  const int count = test::Repetitions(1000000);
  for (int n = 0; n < count; ++n) {
    const Case c = Draw(random);
    AxisMove move = PlanAxisMove(c.start, c.goal_x, c.limits);
    ASSERT_NO_FATAL_FAILURE(CheckDuration(c, move)) << n;
    if (n % 3 == 0) {
      // The same move, in a longer time.
      const double asked_s = move.Duration() * (1.0 + Decades(random, -8, 2));
      move = PlanAxisMove(c.start, c.goal_x, c.limits, asked_s);
      Worse(worst.arrival, asked_s > 0.0 ? std::fabs(move.Duration() / asked_s - 1.0) : 0.0);
      const double arrived_s = move.phases[static_cast<std::size_t>(move.num_phases - 1)].start_s;
      if (arrived_s < asked_s * (1.0 - 1e-9)) {
        ASSERT_TRUE(c.stops_there) << "only a move that stops there may wait at its goal, " << n;
        ++waited;
      }
    }
    ASSERT_NO_FATAL_FAILURE(CheckSeams(c, move, worst)) << n;
    ASSERT_NO_FATAL_FAILURE(CheckSamples(c, move, random, worst)) << n;
    CheckLimits(c, move, worst);
  }
  std::cout << count << " moves; errors at the seams: x " << worst.seam_x << ", v " << worst.seam_v << ", a "
            << worst.seam_a << "; largest shares: v " << worst.use_v << ", a " << worst.use_a << ", jerk "
            << worst.use_j << "; error of the way " << worst.way << ", of the duration " << worst.arrival
            << "; waited at the goal " << waited << "\n";
  EXPECT_LE(worst.seam_x, 1e-13);
  EXPECT_LE(worst.seam_v, 1e-13);
  EXPECT_LE(worst.seam_a, 1e-13);
  EXPECT_LE(worst.use_v, 1.0 + 1e-12);
  EXPECT_LE(worst.use_a, 1.0 + 1e-12);
  EXPECT_LE(worst.use_j, 1.0 + 1e-9);
  EXPECT_LE(worst.way, 1e-13);
  // If the duration is a steep function of the braking time, the last bit of that time shows.
  EXPECT_LE(worst.arrival, 1e-9);
  EXPECT_GT(waited, 0);
}

}  // namespace
}  // namespace fovea::trajectory
