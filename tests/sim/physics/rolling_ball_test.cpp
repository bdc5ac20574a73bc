// SPDX-License-Identifier: Apache-2.0
// The pushed ball compared with the closed form of a ball that slides, rolls and stops.
#include "sim/physics/rolling_ball.hpp"

#include <gtest/gtest.h>

#include <iostream>

namespace fovea::sim {
namespace {

constexpr double kDt = 1e-3;
constexpr double kGravity = 9.81;

RollingBallConfig OnTheTable() {
  RollingBallConfig config;
  config.p_BO = {0.5, 0.1, config.radius};
  config.air_damping = 0.0;
  return config;
}

TEST(RollingBall, LiesStillUntilItIsPushed) {
  RollingBall ball(OnTheTable());
  for (int i = 0; i < 3000; ++i) {
    ball.Step(kDt);
  }
  const double off = (ball.X_BO().translation() - OnTheTable().p_BO).norm();
  std::cout << "moved by " << off << " m in 3 s\n";
  EXPECT_LT(off, 1e-5);
}

// Speed P / m at first; slows by mu g until it rolls at 5/7 of that; then by 5/7 c g / R until it rests.
TEST(RollingBall, SlideRollAndStopMatchTheClosedForm) {
  const RollingBallConfig config = OnTheTable();
  RollingBall ball(config);
  for (int i = 0; i < 100; ++i) {
    ball.Step(kDt);
  }
  const double v0 = 0.3;
  ball.Push({0.0, -config.mass * v0, 0.0});
  EXPECT_NEAR(ball.v_BO().y(), -v0, 1e-6);
  // Sliding: v falls by mu g, and the surface speed rises by 5/2 (mu - c / R) g, until they are equal.
  const double share = config.rolling_resistance / config.radius;
  const double slides_s = v0 / (kGravity * (config.friction + 2.5 * (config.friction - share)));
  const double slows_by_form = 5.0 / 7.0 * share * kGravity;
  const int steps = 30;
  for (int i = 0; i < steps; ++i) {
    ball.Step(kDt);
  }
  const double rolls = -ball.v_BO().y();
  const double rolls_by_form =
      v0 - config.friction * kGravity * slides_s - slows_by_form * (steps * kDt - slides_s);
  std::cout << "rolls at " << rolls << " m/s, closed form " << rolls_by_form << "\n";
  EXPECT_NEAR(rolls, rolls_by_form, 1e-4);
  for (int i = 0; i < 500; ++i) {
    ball.Step(kDt);
  }
  const double slows = (rolls + ball.v_BO().y()) / 0.5;
  std::cout << "slows down by " << slows << " m/s^2, closed form " << slows_by_form << "\n";
  EXPECT_NEAR(slows, slows_by_form, 1e-4);
  for (int i = 0; i < 2000; ++i) {
    ball.Step(kDt);
  }
  const Eigen::Vector3d rest = ball.X_BO().translation();
  for (int i = 0; i < 1000; ++i) {
    ball.Step(kDt);
  }
  const double creeps = (ball.X_BO().translation() - rest).norm();
  std::cout << "creeps by " << creeps << " m/s at rest, height " << rest.z() << " m\n";
  EXPECT_LT(creeps, 1e-5);
  EXPECT_NEAR(rest.z(), config.radius, 1e-4);
}

TEST(RollingBall, SamePushRepeatsBitExact) {
  const auto end = [] {
    RollingBall ball(OnTheTable());
    ball.Push({0.02, -0.05, 0.0});
    for (int i = 0; i < 1500; ++i) {
      ball.Step(kDt);
    }
    return ball.X_BO().matrix().eval();
  };
  EXPECT_EQ(end(), end());
}

}  // namespace
}  // namespace fovea::sim
