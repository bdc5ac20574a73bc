// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "firmware/host/config/servo_keys.hpp"

namespace fovea::config {
namespace {

TEST(ScaleSpeed, SlowsEveryMotionAndStaysWithinWhatInitAllows) {
  const ServoSettings whole;
  const GuardConfig& before = whole.config.guard;
  for (const double scale : {1.0, 0.5, 0.01}) {
    ServoSettings scaled;
    ScaleSpeed(scale, scaled);
    const GuardConfig& after = scaled.config.guard;
    EXPECT_DOUBLE_EQ(scaled.config.law.lambda, scale * whole.config.law.lambda);
    EXPECT_DOUBLE_EQ(after.joint_velocity_fraction, scale * before.joint_velocity_fraction);
    EXPECT_DOUBLE_EQ(after.cartesian_speed, std::max(scale * before.cartesian_speed, kLeastCartesianSpeed));
    EXPECT_DOUBLE_EQ(after.rotation_speed, std::max(scale * before.rotation_speed, kLeastRotationSpeed));
  }
}

}  // namespace
}  // namespace fovea::config
