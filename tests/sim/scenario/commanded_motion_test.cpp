// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/commanded_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fovea::sim {
namespace {

CommandedWaves Waves() {
  CommandedWaves waves;
  waves.from = {0.1, -0.2, 0.3};
  waves.amplitude = {0.5, 0.2, 0.0};
  waves.multiple = {1.0, 3.0, 2.0};
  waves.omega = 1.7;
  return waves;
}

TEST(CommandedWavesTest, BeginAtRest) {
  const moves::MotionCommand start = Waves().At(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(start.q[i], Waves().from[i]);
    EXPECT_EQ(start.dq[i], 0.0);
    EXPECT_EQ(start.ddq[i], 0.0);
  }
}

TEST(CommandedWavesTest, EachJointHasItsFrequencyAfterASecond) {
  const double angle = 1.7 * (3.0 - 0.5);  // the soft start costs half a second
  const moves::MotionCommand command = Waves().At(3.0);
  EXPECT_NEAR(command.q[0], 0.1 + 0.5 * std::sin(angle), 1e-12);
  EXPECT_NEAR(command.q[1], -0.2 + 0.2 * std::sin(3.0 * angle), 1e-12);
  EXPECT_EQ(command.q[2], 0.3);
}

TEST(CommandedWavesTest, VelocityAndAccelerationAreTheDerivatives) {
  constexpr double kStep = 1e-5;
  for (const double t : {0.3, 0.7, 1.0 - 2e-5, 1.5, 4.0}) {
    const moves::MotionCommand here = Waves().At(t);
    const moves::MotionCommand before = Waves().At(t - kStep);
    const moves::MotionCommand after = Waves().At(t + kStep);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(here.dq[i], (after.q[i] - before.q[i]) / (2.0 * kStep), 1e-8) << t;
      EXPECT_NEAR(here.ddq[i], (after.dq[i] - before.dq[i]) / (2.0 * kStep), 1e-7) << t;
    }
  }
}

}  // namespace
}  // namespace fovea::sim
