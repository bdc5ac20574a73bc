// SPDX-License-Identifier: Apache-2.0
// The estimated speed against the analytic answers of a difference and of a first-order filter.
#include "sim/drives/speed_by_differences.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

constexpr double kTick = hal::kTickPeriodS;
constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(SpeedByDifferences, BeginsWithTheSpeedThatItIsGiven) {
  SpeedByDifferences speed(50.0, 0.8);
  EXPECT_EQ(speed.Next(100.0), 0.8);
  EXPECT_NEAR(speed.Next(100.0 + 0.8 * kTick), 0.8, 1e-9);
}

// With a = 1 - exp(-w T): T / 2 + T (1 - a) / a = T / 2 coth(w T / 2), which is near 1 / w.
TEST(SpeedByDifferences, IsLateByHalfATickAndTheFiltersDelay) {
  for (const double corner_hz : {10.0, 50.0, 100.0, 400.0}) {
    SpeedByDifferences speed(corner_hz, 0.0);
    double late_s = 0.0;
    for (int n = 0; n <= 1000; ++n) {
      const double t = kTick * n;
      late_s = t - speed.Next(0.5 * t * t);  // an acceleration of 1 rad/s^2
    }
    const double expected_s = 0.5 * kTick / std::tanh(0.5 * kTurn * corner_hz * kTick);
    std::cout << corner_hz << " Hz: late by " << 1e3 * late_s << " ms\n";
    EXPECT_NEAR(late_s, expected_s, 1e-9) << corner_hz;
  }
}

// At its corner frequency a first-order filter leaves the root of a half.
TEST(SpeedByDifferences, HasItsCornerWhereItShouldBe) {
  constexpr double kCornerHz = 10.0;
  SpeedByDifferences speed(kCornerHz, 0.0);
  double largest = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double y = speed.Next(std::sin(kTurn * kCornerHz * kTick * n) / (kTurn * kCornerHz));
    largest = n > 1000 ? std::max(largest, std::fabs(y)) : 0.0;
  }
  EXPECT_NEAR(largest, std::numbers::sqrt2 / 2.0, 0.002);
}

}  // namespace
}  // namespace fovea::sim
