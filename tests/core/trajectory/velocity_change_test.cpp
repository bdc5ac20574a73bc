// SPDX-License-Identifier: Apache-2.0
// The shortest change of velocity: it ends as planned, keeps its limits, and its positions are consistent.
#include "firmware/core/trajectory/velocity_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::trajectory {
namespace {

TEST(VelocityChangeTest, EndsAtItsVelocityWithinItsLimits) {
  test::RandomStates random(62);
  double worst_end = 0.0;
  double worst_a = 0.0;
  double worst_travel = 0.0;
  for (int n = 0; n < test::Repetitions(200000); ++n) {
    const AxisLimits limits{1.0, std::pow(10.0, random.Uniform(-2.0, 2.0)),
                            std::pow(10.0, random.Uniform(-2.0, 4.0))};
    const double v0 = random.Uniform(-2.0, 2.0);
    const double a0 = random.Uniform(-2.0, 2.0) * limits.a_max;
    const double v1 = random.Uniform(-1.0, 1.0);
    const VelocityChange change = PlanVelocityChange(v0, a0, v1, limits);
    AxisState state{0.0, v0, a0};
    double v_size = std::fabs(v0) + std::fabs(v1);
    for (int k = 0; k < VelocityChange::kNumPhases; ++k) {
      const JerkPhase& phase = change.phases[static_cast<std::size_t>(k)];
      ASSERT_GE(phase.duration_s, 0.0);
      ASSERT_LE(std::fabs(phase.jerk), limits.j_max);
      state = After(state, phase.jerk, phase.duration_s);
      v_size = std::max(v_size, std::fabs(state.v));
      worst_a = std::max(worst_a, std::fabs(state.a) / limits.a_max);
    }
    worst_end = std::max({worst_end, std::fabs(state.v - v1) / v_size, std::fabs(state.a) / limits.a_max});
    const double T = change.Duration();
    worst_travel = std::max({worst_travel, std::fabs(change.Travel() - state.x) / (v_size * T + 1e-300),
                             std::fabs(change.At(T + 1.0).x - state.x - v1) / (v_size * (T + 1.0))});
  }
  std::cout << "error of the end " << worst_end << ", of the way " << worst_travel
            << "; largest share of the acceleration " << worst_a << "\n";
  EXPECT_LE(worst_end, 1e-13);
  EXPECT_LE(worst_travel, 1e-13);
  EXPECT_LE(worst_a, 1.0 + 1e-13);
}

// A path keeps the states in which the phases begin, and gives the same bits at all times.
TEST(VelocityChangeTest, PathIsTheChangeToTheLastBit) {
  test::RandomStates random(63);
  for (int n = 0; n < test::Repetitions(20000); ++n) {
    const AxisLimits limits{1.0, std::pow(10.0, random.Uniform(-2.0, 2.0)),
                            std::pow(10.0, random.Uniform(-2.0, 4.0))};
    const VelocityChange change =
        PlanVelocityChange(random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0) * limits.a_max,
                           random.Uniform(-1.0, 1.0), limits);
    const VelocityPath path(change);
    for (const double share : {-0.1, 0.0, random.Uniform(0.0, 1.0), random.Uniform(0.0, 1.0), 1.0, 1.1}) {
      const AxisState expected = change.At(share * change.Duration());
      const AxisState state = path.At(share * change.Duration());
      ASSERT_EQ(state.x, expected.x) << "case " << n << " at " << share;
      ASSERT_EQ(state.v, expected.v) << "case " << n << " at " << share;
      ASSERT_EQ(state.a, expected.a) << "case " << n << " at " << share;
    }
  }
}

// A stop does not reverse if its joint would go on when its acceleration is released: then it is furthest
// away at its end. The proof of a stop (stop_path.cpp) relies on it.
TEST(VelocityChangeTest, StopThatWouldGoOnDoesNotReverse) {
  test::RandomStates random(64);
  int num_going_on = 0;
  double worst = 0.0;
  for (int n = 0; n < test::Repetitions(20000); ++n) {
    const double a_max = random.Uniform(1.0, 15.0);
    const double jerk = random.Uniform(50.0, 5000.0);
    const double v = random.Uniform(-1.0, 1.0);
    const double a = random.Uniform(-1.5, 1.5) * a_max;
    if (v * SettledVelocity(v, a, jerk) < 0.0) {
      continue;
    }
    ++num_going_on;
    const VelocityChange stop = PlanVelocityChange(v, a, 0.0, {1.0, a_max, jerk});
    const double end = std::fabs(stop.Travel());
    for (int i = 0; i <= 50; ++i) {
      worst = std::max(worst, std::fabs(stop.At(stop.Duration() * i / 50.0).x) - end);
    }
  }
  std::cout << num_going_on << " stops; furthest beyond the end " << worst << "\n";
  EXPECT_GT(num_going_on, test::Repetitions(20000) / 10);
  EXPECT_LE(worst, 1e-12);
}

// Checked from its positions alone.
TEST(VelocityChangeTest, StopComesToRestWithinItsLimits) {
  test::RandomStates random(61);
  double worst_start = 0.0;
  double worst_end = 0.0;
  double worst_a = 0.0;
  double worst_jerk = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double a_max = random.Uniform(1.0, 15.0);
    const double jerk = random.Uniform(50.0, 5000.0);
    const double dq = random.Uniform(-2.0, 2.0);
    const double ddq = random.Uniform(-a_max, a_max);
    const VelocityChange stop = PlanVelocityChange(dq, ddq, 0.0, {1.0, a_max, jerk});
    const double T = stop.Duration();
    const auto x = [&](double t) { return stop.At(t).x; };
    const double h = T / 500;
    const auto velocity = [&](double t) { return (x(t + h) - x(t - h)) / (2.0 * h); };
    const auto acceleration = [&](double t) { return (x(t + h) - 2.0 * x(t) + x(t - h)) / (h * h); };
    // A central difference of a cubic is off by jerk h^2 / 6 and jerk h.
    worst_start = std::max(worst_start, std::abs(velocity(h) - dq - ddq * h) - jerk * h * h);
    worst_end =
        std::max(worst_end, std::abs(x(T) - x(T + 10.0)) + std::abs(x(T) - x(T - h)) - jerk * h * h * h);
    double last = ddq;
    for (int i = 1; i < 500; ++i) {
      const double a = acceleration(i * h);
      worst_a = std::max(worst_a, std::abs(a) / a_max);
      worst_jerk = std::max(worst_jerk, std::abs(a - last) / h / jerk);
      last = a;
    }
  }
  std::cout << "error of the start " << worst_start << " rad/s, of the rest at the end " << worst_end
            << " rad; largest shares: acceleration " << worst_a << ", jerk " << worst_jerk << "\n";
  EXPECT_LE(worst_start, 0.0);
  EXPECT_LE(worst_end, 0.0);
  EXPECT_LE(worst_a, 1.0 + 1e-6);
  EXPECT_LE(worst_jerk, 1.0 + 1e-3);
}

TEST(VelocityChangeTest, StopFromRestHasZeroDuration) {
  const VelocityChange stop = PlanVelocityChange(0.0, 0.0, 0.0, {1.0, 5.0, 500.0});
  EXPECT_EQ(stop.Duration(), 0.0);
  EXPECT_EQ(stop.At(1.0).x, 0.0);
}

TEST(VelocityChangeTest, EqualVelocitiesGiveZeroDuration) {
  const VelocityChange change = PlanVelocityChange(0.5, 0.0, 0.5, {1.0, 2.0, 3.0});
  EXPECT_EQ(change.Duration(), 0.0);
  EXPECT_EQ(change.Travel(), 0.0);
  EXPECT_EQ(change.At(2.0).x, 1.0);
}

}  // namespace
}  // namespace fovea::trajectory
