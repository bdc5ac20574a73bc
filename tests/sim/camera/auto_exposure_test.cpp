// SPDX-License-Identifier: Apache-2.0
// Automatic exposure: approaches its level with its time constant, two pictures late, in any order of
// drawing.
#include "sim/camera/auto_exposure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

namespace fovea::sim {
namespace {

constexpr std::int64_t kPeriodNs = 10'000'000;

// In a step of the light, ln(gain) decays to its new value as exp(-t / lag).
TEST(AutoExposureTest, GainFollowsAStepOfTheLightWithItsTimeConstant) {
  constexpr double kLag_s = 0.2;
  AutoExposure exposure({.level = 120.0, .lag_s = kLag_s, .gain_max = 16.0});
  double worst = 0.0;
  for (int k = 0; k < 100; ++k) {
    const auto index = static_cast<std::uint64_t>(k);
    const std::optional<double> gain = exposure.TakeGain(index);
    ASSERT_TRUE(gain.has_value()) << k;
    // The first measured picture is at time 0 and changes nothing; picture k has the gain of picture k - 2.
    const double since_s = 1e-9 * static_cast<double>(std::max(k - 2, 0) * kPeriodNs);
    const double expected = std::log(120.0 / 30.0) * (1.0 - std::exp(-since_s / kLag_s));
    worst = std::max(worst, std::fabs(std::log(*gain) - expected));
    exposure.Measure(index, k * kPeriodNs, Brightness{30.0 * *gain, *gain});
  }
  std::cout << "ln(gain) is off its exponential by at most " << worst << "\n";
  EXPECT_LT(worst, 1e-12);
}

TEST(AutoExposureTest, GainStaysWithinItsBounds) {
  AutoExposure exposure({.level = 120.0, .lag_s = 0.001, .gain_max = 4.0});
  for (std::uint64_t k = 0; k < 20; ++k) {
    exposure.Measure(k, static_cast<std::int64_t>(k) * kPeriodNs, Brightness{k < 10 ? 1.0 : 255.0, 1.0});
  }
  EXPECT_NEAR(exposure.TakeGain(11).value(), 4.0, 1e-12);
  EXPECT_NEAR(exposure.TakeGain(21).value(), 120.0 / 255.0, 1e-4);
}

TEST(AutoExposureTest, GainIsUnknownUntilThePictureTwoBeforeIsMeasured) {
  AutoExposure exposure({.level = 120.0, .lag_s = 0.001});
  EXPECT_EQ(exposure.TakeGain(0), 1.0);
  EXPECT_EQ(exposure.TakeGain(1), 1.0);
  exposure.Measure(1, kPeriodNs, Brightness{60.0, 1.0});
  EXPECT_FALSE(exposure.TakeGain(2).has_value());
  EXPECT_FALSE(exposure.TakeGain(3).has_value());
  exposure.Measure(0, 0, std::nullopt);  // was lost
  EXPECT_EQ(exposure.TakeGain(2), 1.0);
  EXPECT_NEAR(exposure.TakeGain(3).value(), 2.0, 1e-3);
}

TEST(AutoExposureTest, WithoutALevelTheGainIsOne) {
  AutoExposure exposure({});
  EXPECT_EQ(exposure.TakeGain(1000), 1.0);
}

}  // namespace
}  // namespace fovea::sim
