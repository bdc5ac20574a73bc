// SPDX-License-Identifier: Apache-2.0
// Bodies fixed to the hand: capsules covered by balls, and their distance to planes and boxes.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/guard/stop_path.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

TEST(HandShapeTest, SpheresCoverTheCapsuleWithLittleExcess) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 a = 0.1 * Vec3(uniform(random), uniform(random), uniform(random));
    const Vec3 b = a + 0.1 * Vec3(uniform(random), uniform(random), uniform(random));
    const double radius = 0.03 + 0.01 * uniform(random);
    config::HandShape hand;
    ASSERT_TRUE(hand.AddCapsule(a, b, radius));
    for (int j = 0; j < 100; ++j) {
      const Vec3 off = Vec3(uniform(random), uniform(random), uniform(random)).normalized() * radius;
      const Vec3 p = a + 0.5 * (1.0 + uniform(random)) * (b - a) + off;
      double outside = HUGE_VAL;
      for (int i = 0; i < hand.num_balls; ++i) {
        const config::HandShape::Ball& ball = hand.balls[static_cast<std::size_t>(i)];
        outside = std::min(outside, (p - ball.p_EP).norm() - ball.radius);
      }
      ASSERT_LE(outside, 1e-12);
    }
    most = std::max(most, hand.balls[0].radius / radius);
  }
  std::cout << "balls are larger by at most " << 100.0 * (most - 1.0) << " %\n";
  EXPECT_LT(most, 1.12);
}

TEST(HandShapeTest, RefusesACapsuleBeyondItsCapacity) {
  config::HandShape hand;
  EXPECT_FALSE(hand.AddCapsule(Vec3::Zero(), Vec3(1.0, 0.0, 0.0), 0.01));
}

// The lens of a camera 0.2 m from the flange once stood inside a box that the flange stayed out of.
TEST(HandShapeTest, CameraIsKeptOutOfABoxTheFlangeDoesNotReach) {
  config::ServoConfig config = test::PandaConfig();
  model::ArmPoses poses;
  model::ComputePoses(config.arm, test::Ready(), poses);
  const Vec3 p_EC(0.0, 0.0, 0.2);
  const Vec3 lens = poses.X_BE * p_EC;
  config.guard.rotation_speed = 100.0;  // only the box shall limit
  config.guard.obstacles.num_boxes = 1;
  config.guard.obstacles.boxes[0] = {lens - Vec3(0.05, 0.05, 0.1), lens + Vec3(0.05, 0.05, -0.06)};
  const trajectory::Reference reference{test::Ready(), model::VecN::Zero(7), model::VecN::Zero(7)};
  EXPECT_GT(ClearanceOfArm(config, poses), 0.1) << "the flange alone is far away";
  ASSERT_TRUE(config.guard.hand.AddCapsule(Vec3::Zero(), p_EC, 0.03));
  EXPECT_NEAR(ClearanceOfArm(config, poses), 0.03, 0.004);
  // Moving down: a stop ends inside the box for the camera, but not for the flange.
  model::LinearJacobian J;
  model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J);
  const auto passed = [&](const trajectory::Reference& next) {
    model::LazyPoses now(config.arm, reference.q);
    guard::KnownClearances known;
    return guard::LimitsPassed(config, next, now, known);
  };
  trajectory::Reference down = reference;
  down.dq = J.transpose() * (J * J.transpose()).inverse() * Vec3(0.0, 0.0, -0.9);
  down.q += 1e-3 * down.dq;
  EXPECT_EQ(passed(down), hal::Bit(hal::Limit::kObstacle));
  down.dq = -down.dq;
  EXPECT_EQ(passed(down), 0U);
  config.guard.hand = config::HandShape{};
  down.dq = -down.dq;
  EXPECT_EQ(passed(down), 0U);
}

}  // namespace
}  // namespace fovea::barriers
