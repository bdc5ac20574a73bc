// SPDX-License-Identifier: Apache-2.0
// The speed with which a barrier may be approached.
#include "firmware/core/barriers/barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fovea::barriers {
namespace {

TEST(BarrierTest, RateLimitsTheApproachToExponentialDecay) {
  Barrier barrier;
  barrier.margin = 0.1;
  barrier.rate = 3.0;
  constexpr double kDt = 1e-4;
  double h = 0.6;
  for (int k = 1; k <= 20000; ++k) {
    barrier.value = h;
    h -= kDt * barrier.SpeedMost();
    ASSERT_GE(h, barrier.margin);
    ASSERT_NEAR(h - barrier.margin, 0.5 * std::exp(-3.0 * k * kDt), 1e-4);
  }
}

TEST(BarrierTest, DriftLowersTheSpeedLimitButNotBelowZero) {
  Barrier barrier;
  barrier.value = 0.3;
  barrier.rate = 2.0;
  barrier.drift = -0.4;
  EXPECT_NEAR(barrier.SpeedMost(), 0.2, 1e-15);
  barrier.drift = -5.0;
  EXPECT_EQ(barrier.SpeedMost(), 0.0);
  barrier.drift = 0.0;
  barrier.margin = 0.4;
  EXPECT_EQ(barrier.SpeedMost(), 0.0);
}

// From the largest speed the deceleration, which begins a reaction time late, stops exactly at the margin.
TEST(BarrierTest, SpeedLimitAllowsAStopBeforeTheMargin) {
  Barrier barrier;
  barrier.deceleration = 2.0;
  barrier.reaction_s = 0.05;
  for (int k = 0; k <= 100; ++k) {
    const double room = 0.01 * k;
    barrier.value = room;
    const double speed = barrier.SpeedMost();
    EXPECT_NEAR(speed * 0.05 + speed * speed / 4.0, room, 1e-12);
  }
  barrier.value = -0.01;
  EXPECT_EQ(barrier.SpeedMost(), 0.0);
}

TEST(BarrierTest, ReturnRateDemandsARetreatPastTheMargin) {
  Barrier barrier;
  barrier.deceleration = 2.0;
  barrier.return_rate = 5.0;
  barrier.return_speed = 0.02;
  barrier.value = -0.001;
  EXPECT_NEAR(barrier.SpeedMost(), -0.005, 1e-15);
  barrier.value = -0.1;
  EXPECT_EQ(barrier.SpeedMost(), -0.02);
}

}  // namespace
}  // namespace fovea::barriers
