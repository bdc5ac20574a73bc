// SPDX-License-Identifier: Apache-2.0
// The change of velocity tick by tick, against the time optimum of velocity_change.hpp.
#include "firmware/core/trajectory/velocity_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "fovea/hal/types.hpp"
#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::trajectory {
namespace {

constexpr double kPeriodS = hal::kTickPeriodS;
constexpr AxisLimits kLimits{2.0, 10.0, 400.0};  // a joint of the Panda

TEST(VelocityStepTest, MatchesTheTimeOptimumWithinLimitsWithoutOvershoot) {
  test::RandomStates random(11);
  int latest = 0;
  double most_over = 0.0;
  for (int k = 0; k < test::Repetitions(20'000); ++k) {
    AxisState state{0.0, random.Uniform(-2.0, 2.0), random.Uniform(-10.0, 10.0)};
    const double v = random.Uniform(-2.0, 2.0);
    const double optimum_s = PlanVelocityChange(state.v, state.a, v, kLimits).Duration();
    // If reducing the acceleration to zero leads beyond v, that overshoot cannot be avoided.
    const double settled = SettledVelocity(state.v, state.a, kLimits.j_max);
    const double high = std::max({state.v, settled, v});
    const double low = std::min({state.v, settled, v});
    int ticks = 0;
    while (std::fabs(state.v - v) > 1e-9 || std::fabs(state.a) > 1e-6) {
      const double a_before = state.a;
      state = StepVelocity(state, v, 0.0, kLimits, kPeriodS).state;
      ASSERT_LE(std::fabs(state.a), kLimits.a_max);
      ASSERT_LE(std::fabs(state.a - a_before), kLimits.j_max * kPeriodS * (1.0 + 1e-9));
      most_over = std::max({most_over, state.v - high, low - state.v});
      ASSERT_LT(++ticks, 2000) << "from " << state.v << " to " << v;
    }
    latest = std::max(latest, ticks - static_cast<int>(std::ceil(optimum_s / kPeriodS)));
  }
  std::cout << "at most " << latest << " ticks later than the optimum, at most " << most_over
            << " rad/s beyond the velocity\n";
  EXPECT_LE(latest, 2);
  EXPECT_LT(most_over, 0.15 * kLimits.j_max * kPeriodS * kPeriodS);  // caused by the tick grid
}

TEST(VelocityStepTest, FollowsAChangingVelocity) {
  AxisState state;
  double worst = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double t = (k + 1) * kPeriodS;
    state = StepVelocity(state, std::sin(2.0 * t), 2.0 * std::cos(2.0 * t), kLimits, kPeriodS).state;
    if (k > 100) {
      worst = std::max(worst, std::fabs(state.v - std::sin(2.0 * t)));
    }
  }
  std::cout << "off by " << worst << " rad/s at most\n";
  EXPECT_LT(worst, 1e-12);
}

TEST(VelocityStepTest, ReportsTheLimitThatActed) {
  const VelocityStep idle = StepVelocity({0.0, 1.0, 0.0}, 1.0, 0.0, kLimits, kPeriodS);
  EXPECT_FALSE(idle.at_a_max || idle.at_j_max);
  const VelocityStep ramp = StepVelocity({0.0, 0.0, 0.0}, 1.0, 0.0, kLimits, kPeriodS);
  EXPECT_TRUE(ramp.at_j_max);
  const VelocityStep full = StepVelocity({0.0, 0.0, 10.0}, 2.0, 0.0, kLimits, kPeriodS);
  EXPECT_TRUE(full.at_a_max && !full.at_j_max);
}

}  // namespace
}  // namespace fovea::trajectory
