// SPDX-License-Identifier: Apache-2.0
// A picture that stays the same although the hand moves: the target at rest on the table, or in the camera.
#include "firmware/core/estimate/stuck_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using model::Pose;
using model::Vec3;

constexpr double kStuckShift = 0.0036;  // servo.stuck_shift_px = 2

// A camera that settles: it turns by 0.3 degrees and moves by a millimetre in any direction, 0.4 to 0.8 m
// before a target that it measures `noise` of its distance too near or too far, and in the right direction.
int CountStuck(bool hangs, double noise, int trials) {
  std::mt19937_64 engine(20261130);
  std::normal_distribution<double> normal;
  const auto any = [&](double size) {
    const Vec3 direction(normal(engine), normal(engine), normal(engine));
    return Vec3(size * direction.normalized());
  };
  int stuck = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Pose X_BC{model::RotationOf(any(2.0)), any(0.5)};
    const Pose X_BC_now{X_BC.R * model::RotationOf(any(0.005)), X_BC.p + any(0.001)};
    const Vec3 p_C = Vec3(0.1 * normal(engine), 0.1 * normal(engine), 0.6 + 0.05 * normal(engine));
    const Vec3 p_C_now = hangs ? p_C : Vec3(X_BC_now.Inverse() * (X_BC * p_C));
    const auto measured = [&](const Vec3& p) { return Vec3((1.0 + noise * normal(engine)) * p); };
    StuckPicture picture;
    (void)IsStuck(kStuckShift, {0, X_BC, X_BC, measured(p_C), {}}, picture);
    stuck += IsStuck(kStuckShift, {0, X_BC, X_BC_now, measured(p_C_now), {}}, picture) ? 1 : 0;
  }
  return stuck;
}

TEST(StuckPictureTest, DepthThatIsMeasuredBadlyTellsNothing) {
  constexpr int kTrials = 2000;
  for (const double noise : {0.0, 0.002, 0.02}) {
    const int hangs = CountStuck(true, noise, kTrials);
    const int settles = CountStuck(false, noise, kTrials);
    std::cout << "depth within " << 100.0 * noise << " %: of " << kTrials << ", stuck " << hangs
              << " if the camera hangs, " << settles << " if the arm settles\n";
    EXPECT_GT(hangs, kTrials * 17 / 20);  // the other steps are too small to be judged
    EXPECT_LT(settles, kTrials / 50);
  }
}

// A camera that turns about its axis above a square: the middle stays, the corners do not.
TEST(StuckPictureTest, RollIsToldByTheCorners) {
  constexpr double kNoise = 2e-4;  // of a corner
  constexpr int kTrials = 500;
  std::mt19937_64 engine(20261131);
  std::normal_distribution<double> normal;
  const Vec3 p_C(0.0, 0.0, 0.6);
  const auto corners = [&](double turn) {
    features::SeenCorners::Vector xy(8);
    for (int i = 0; i < 4; ++i) {
      const double angle = turn + 0.5 * std::numbers::pi * i;
      xy.segment<2>(2 * i) << 0.1 * std::cos(angle) + kNoise * normal(engine),
          0.1 * std::sin(angle) + kNoise * normal(engine);
    }
    return xy;
  };
  int hangs = 0;
  int settles = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    constexpr double kTurn = 0.02;
    const Pose X_BC;
    const Pose X_BC_now{model::RotationOf({0.0, 0.0, kTurn}), Vec3::Zero()};
    StuckPicture picture;
    (void)IsStuck(kStuckShift, {0, X_BC, X_BC, p_C, corners(0.0)}, picture);
    hangs += IsStuck(kStuckShift, {0, X_BC, X_BC_now, p_C, corners(0.0)}, picture) ? 1 : 0;
    settles += IsStuck(kStuckShift, {0, X_BC, X_BC_now, p_C, corners(-kTurn)}, picture) ? 1 : 0;
  }
  std::cout << "of " << kTrials << ", stuck " << hangs << " if the camera hangs, " << settles
            << " if it does not\n";
  EXPECT_EQ(hangs, kTrials);
  EXPECT_EQ(settles, 0);
}

// A camera that moves along its axis to a target in the middle of the picture: only the depth changes.
TEST(StuckPictureTest, ApproachAlongTheAxisIsToldByTheDepth) {
  const Vec3 p_C(0.0, 0.0, 0.6);
  const Pose X_BC;
  const Pose X_BC_now{model::Mat3::Identity(), {0.0, 0.0, 0.06}};
  StuckPicture picture;
  (void)IsStuck(kStuckShift, {0, X_BC, X_BC, p_C, {}}, picture);
  EXPECT_TRUE(IsStuck(kStuckShift, {0, X_BC, X_BC_now, p_C, {}}, picture));
  EXPECT_FALSE(IsStuck(kStuckShift, {0, X_BC, X_BC_now, p_C - Vec3(0.0, 0.0, 0.06), {}}, picture));
}

}  // namespace
}  // namespace fovea::estimate
