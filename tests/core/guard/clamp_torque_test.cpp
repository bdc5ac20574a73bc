// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/clamp_torque.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::guard {
namespace {

TEST(ClampTorqueTest, AnyTorqueIsClampedToRangeAndRate) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(41);
  const double odd[] = {std::nan(""), std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(), 1e308, 0.0};
  for (int k = 0; k < 100'000; ++k) {
    model::VecN applied(7);
    model::VecN tau = random.Joints(config.arm, k % 2 == 0 ? 200.0 : 2.0);
    for (int i = 0; i < 7; ++i) {
      const double range = config.arm.joints[static_cast<std::size_t>(i)].tau_max;
      applied[i] = random.Uniform(-range, range);
    }
    if (k % 5 == 0) {
      tau[k % 7] = odd[static_cast<std::size_t>(k / 5) % 5];
    }
    const bool finite = tau.allFinite();
    const ClampResult result = ClampTorque(config.arm, config.safety, applied, tau);
    EXPECT_EQ(result.finite, finite);
    for (int i = 0; i < 7; ++i) {
      const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
      ASSERT_LE(std::abs(tau[i]), joint.tau_max);
      ASSERT_LE(std::abs(tau[i] - applied[i]), joint.dtau_max * 1e-3 + 1e-12);
    }
  }
}

TEST(ClampTorqueTest, LeavesATorqueWithinLimitsUnchanged) {
  const config::ServoConfig config = test::PandaConfig();
  model::VecN applied = model::VecN::Zero(7);
  model::VecN tau = model::VecN::Constant(7, 0.9);
  const model::VecN wish = tau;
  const ClampResult result = ClampTorque(config.arm, config.safety, applied, tau);
  EXPECT_EQ(tau, wish);
  EXPECT_EQ(result.limits, 0U);
  EXPECT_TRUE(result.finite);
}

TEST(ClampTorqueTest, NamesTheLimitThatActed) {
  const config::ServoConfig config = test::PandaConfig();
  model::VecN applied = model::VecN::Constant(7, 11.9);
  model::VecN tau = model::VecN::Constant(7, 12.5);  // above the range of joints 5 to 7 only
  EXPECT_EQ(ClampTorque(config.arm, config.safety, applied, tau).limits, hal::Bit(hal::Limit::kTorque));
  EXPECT_EQ(tau[6], 12.0);
  EXPECT_EQ(tau[0], 12.5);
  tau = model::VecN::Zero(7);
  EXPECT_EQ(ClampTorque(config.arm, config.safety, applied, tau).limits, hal::Bit(hal::Limit::kTorqueRate));
  EXPECT_NEAR(tau[0], 10.9, 1e-12);
}

TEST(ClampTorqueTest, NonFiniteTorqueFadesToZero) {
  const config::ServoConfig config = test::PandaConfig();
  model::VecN applied = model::VecN::Constant(7, 5.0);
  for (int tick = 0; tick < 10; ++tick) {
    model::VecN tau = model::VecN::Constant(7, std::nan(""));
    EXPECT_FALSE(ClampTorque(config.arm, config.safety, applied, tau).finite);
    applied = tau;
  }
  EXPECT_EQ(applied.norm(), 0.0);
}

TEST(ClampTorqueTest, LimitsScaleWithTheirFractions) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.torque_fraction = 0.1;
  config.safety.torque_rate_fraction = 0.5;
  model::VecN applied = model::VecN::Zero(7);
  model::VecN tau = model::VecN::Constant(7, 1000.0);
  EXPECT_NE(ClampTorque(config.arm, config.safety, applied, tau).limits, 0U);
  EXPECT_NEAR(tau[0], 0.5, 1e-12);
  applied = model::VecN::Constant(7, 8.5);
  tau = model::VecN::Constant(7, 1000.0);
  EXPECT_NE(ClampTorque(config.arm, config.safety, applied, tau).limits, 0U);
  EXPECT_NEAR(tau[0], 8.7, 1e-12);
}

}  // namespace
}  // namespace fovea::guard
