// SPDX-License-Identifier: Apache-2.0
// Single examples of moves of one axis, and the durations of others against least ones that a linear
// programme found (axis_move_optimum.py).
#include "firmware/core/trajectory/axis_move.hpp"
#include "tests/support/places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

namespace fovea::trajectory {
namespace {

// Calls `look` with the state at the start of each of a thousand equal parts of a move.
template <typename Look>
void ForEachState(const AxisMove& move, Look look) {
  for (int i = 0; i < 1000; ++i) {
    look(move.At(move.Duration() * i / 1000));
  }
}

TEST(AxisMoveTest, IsAsFastAsTheLinearProgramme) {
  std::ifstream file(test::SourceRoot() / "tests/core/trajectory/axis_move_optimum.csv");
  int cases = 0;
  double fastest = 1.0;
  double slowest = 0.0;
  double sum = 0.0;
  double below_error = 0.0;
  for (std::string line; std::getline(file, line);) {
    AxisState start;
    AxisLimits limits;
    double goal_x = 0.0;
    double optimum_s = 0.0;
    double error_s = 0.0;
    if (std::sscanf(line.c_str(), "%*[a-z],%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &start.v, &start.a, &goal_x,
                    &limits.v_max, &limits.a_max, &limits.j_max, &optimum_s, &error_s) != 8) {
      continue;
    }
    const double ratio = PlanAxisMove(start, goal_x, limits).Duration() / optimum_s;
    ++cases;
    sum += ratio;
    fastest = std::min(fastest, ratio);
    slowest = std::max(slowest, ratio);
    // Twice the steps removed error_s. All further steps remove about a third of it, at worst as much again.
    below_error = std::max(below_error, 1.0 - ratio - error_s / optimum_s);
  }
  ASSERT_EQ(cases, 300);
  std::cout << cases << " cases: duration relative to the programme's: mean " << sum / cases << ", worst "
            << slowest << ", least " << fastest << " (less its own error, " << below_error << " below 1)\n";
  EXPECT_LE(slowest, 1.0 + 1e-5);
  EXPECT_GE(fastest, 1.0 - 5e-4);
  EXPECT_LE(below_error, 5e-5);
}

TEST(AxisMoveTest, StartAtTheGoalStaysThere) {
  const AxisMove move = PlanAxisMove({1.5, 0.0, 0.0}, 1.5, {1.0, 1.0, 1.0});
  EXPECT_EQ(move.Duration(), 0.0);
  const AxisMove longer = PlanAxisMove({1.5, 0.0, 0.0}, 1.5, {1.0, 1.0, 1.0}, 4.0);
  EXPECT_EQ(longer.Duration(), 4.0);
  EXPECT_EQ(longer.At(2.0).x, 1.5);
  EXPECT_EQ(longer.At(2.0).v, 0.0);
}

TEST(AxisMoveTest, OvershootsAndReturnsWhenItCannotStopInTime) {
  const AxisMove move = PlanAxisMove({0.0, 1.0, 0.0}, 0.1, {1.0, 1.0, 10.0});
  double furthest = 0.0;
  ForEachState(move, [&](const AxisState& state) { furthest = std::max(furthest, state.x); });
  // It brakes fully until it reverses: 0.1 s of full jerk, then from 0.95 m/s at 1 m/s^2.
  EXPECT_NEAR(furthest, 0.1 - 0.01 / 6.0 + 0.5 * 0.95 * 0.95, 1e-6);
  EXPECT_LT(move.At(move.Duration() - 1e-3).v, 0.0);
}

TEST(AxisMoveTest, AboveTheVelocityLimitBrakesToANearGoalWithoutAPause) {
  const AxisLimits limits{1.0, 2.0, 20.0};
  const VelocityChange stop = PlanVelocityChange(2.0, 0.0, 0.0, limits);
  const AxisMove move = PlanAxisMove({0.0, 2.0, 0.0}, stop.Travel(), limits);
  EXPECT_NEAR(move.Duration(), stop.Duration(), 1e-4) << "no pause at the limit";
}

TEST(AxisMoveTest, TakesALongerTimeByCruisingSlower) {
  const AxisLimits limits{1.0, 2.0, 20.0};
  const AxisState start{0.0, 0.5, 0.0};
  const double T = 2.0 * PlanAxisMove(start, 2.0, limits).Duration();
  const AxisMove move = PlanAxisMove(start, 2.0, limits, T);
  double last = start.v;
  ForEachState(move, [&](const AxisState& state) {
    EXPECT_LE(state.v, last + 1e-12) << "the axis must not speed up again, at " << state.x;
    last = state.v;
  });
  EXPECT_NEAR(move.At(0.5 * T).v, 2.0 / T, 0.1);
}

TEST(AxisMoveTest, EasesItsBrakingWhenTheGoalIsSlightlyFurther) {
  const AxisLimits limits{2.0, 1.0, 10.0};
  const AxisState start{0.0, 1.0, -1.0};
  const VelocityChange stop = PlanVelocityChange(start.v, start.a, 0.0, limits);
  const double goal_x = stop.Travel() + 1e-2;
  const AxisMove move = PlanAxisMove(start, goal_x, limits);
  double a_max = -1.0;
  ForEachState(move, [&](const AxisState& state) { a_max = std::max(a_max, state.a); });
  EXPECT_LT(a_max, 0.0) << "the acceleration never comes to zero on the way";
  // Longer durations, up to twice this one, do not wait at the goal either.
  for (int i = 0; i < 100; ++i) {
    const double asked_s = (1.0 + 0.01 * i) * move.Duration();
    const AxisMove longer = PlanAxisMove(start, goal_x, limits, asked_s);
    EXPECT_NEAR(longer.phases[static_cast<std::size_t>(longer.num_phases - 1)].start_s, asked_s, 1e-12);
  }
}

}  // namespace
}  // namespace fovea::trajectory
