// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/target_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>

#include "sim/world/world.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;

Eigen::Isometry3d At(double x, double y, double z, double yaw = 0.0) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x, y, z;
  X.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return X;
}

TEST(TargetHand, WithoutATouchTheScenarioDecides) {
  EXPECT_FALSE(TargetHand(0.04).At(1'000 * kMs).has_value());
}

TEST(TargetHand, DragsSmoothlyAndStays) {
  TargetHand hand(0.04);
  hand.Drag(At(0.5, 0.1, 0.04), At(0.6, 0.1, 0.10, 1.0), 100 * kMs);
  EXPECT_TRUE(hand.held());
  EXPECT_LT((hand.At(100 * kMs)->translation() - Eigen::Vector3d(0.5, 0.1, 0.04)).norm(), 1e-12);
  double largest_step = 0.0;
  for (std::int64_t t = 100 * kMs; t < 200 * kMs; t += kMs) {
    largest_step =
        std::max(largest_step, (hand.At(t + kMs)->translation() - hand.At(t)->translation()).norm());
  }
  EXPECT_LT(largest_step, 0.117 * TargetHand::kFollowRate * std::exp(-1.0) * 1e-3)
      << "the spring's top speed";
  hand.Release();
  EXPECT_FALSE(hand.held());
  EXPECT_TRUE(hand.At(10'000 * kMs)->isApprox(At(0.6, 0.1, 0.10, 1.0), 1e-12));
}

// The wishes of a slow mouse come late and far apart. The target neither stops between them nor jumps.
TEST(TargetHand, UnevenWishesMoveItEvenly) {
  TargetHand hand(0.04);
  Eigen::Isometry3d now = At(0.5, 0.0, 0.04);
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double most_jump = 0.0;
  double least = 1.0;
  const std::vector<std::int64_t> pauses{33, 140, 33, 120, 150, 40, 110, 33, 140, 100};
  std::int64_t t = 0;
  for (std::size_t i = 0; i < pauses.size(); ++i) {
    hand.Drag(now, At(0.5 + 0.02 * static_cast<double>(i + 1), 0.0, 0.04), t * kMs);
    for (std::int64_t k = 0; k < pauses[i]; ++k) {
      const Eigen::Isometry3d next = *hand.At(++t * kMs);
      const Eigen::Vector3d moved = (next.translation() - now.translation()) / 1e-3;
      most_jump = std::max(most_jump, (moved - velocity).norm());
      least = t > 250 ? std::min(least, moved.x()) : least;
      velocity = moved;
      now = next;
    }
  }
  std::cout << "velocity changes by at most " << most_jump << " m/s in 1 ms, and is at least " << least
            << '\n';
  EXPECT_LT(most_jump, 0.01);
  EXPECT_GT(least, 0.05);
}

TEST(TargetHand, AThrownTargetSlowsDownToRest) {
  TargetHand hand(0.04);
  const Eigen::Vector3d v(0.3, -0.2, 0.0);
  const Eigen::Vector3d omega(0.0, 0.0, 1.0);
  hand.Throw(At(0.5, 0.1, 0.04), v, omega, 0);
  const Eigen::Vector3d speed = (hand.At(kMs)->translation() - hand.At(0)->translation()) / 1e-3;
  EXPECT_LT((speed - v).norm(), 0.002 * v.norm());
  const Eigen::Isometry3d rest = *hand.At(60'000 * kMs);
  const Eigen::Vector3d way = rest.translation() - Eigen::Vector3d(0.5, 0.1, 0.04);
  EXPECT_LT((way - v * TargetHand::kSlowdownS).norm(), 1e-9);
  EXPECT_TRUE(rest.linear().isApprox(At(0, 0, 0, TargetHand::kSlowdownS).linear(), 1e-9));
}

TEST(TargetHand, StaysAboveTheTableAndBelowItsTopSpeed) {
  TargetHand hand(0.04);
  hand.Throw(At(0.5, 0.0, 0.3), {0.0, 0.0, -100.0}, {0.0, 0.0, 0.0}, 0);
  const double drop = 0.3 - hand.At(10 * kMs)->translation().z();
  EXPECT_LE(drop, TargetHand::kMostSpeed * 0.010);
  EXPECT_EQ(hand.At(10'000 * kMs)->translation().z(), 0.04);
  hand.Drag(At(0.5, 0.0, 0.04), At(0.5, 0.0, -1.0), 0);
  EXPECT_EQ(hand.At(1'000 * kMs)->translation().z(), 0.04);
}

TEST(TargetHand, TheWorldPutsTheTargetThere) {
  WorldConfig config;
  config.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  config.q_start.resize(7);
  config.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
  config.target = {MotionKind::kCircle, {0.5, 0.1, 0.04}, 0.10, 0.2};
  World world(config);
  world.AdvanceTo(100 * kMs);
  const Eigen::Vector3d by_the_scenario = world.truth().p_BO;
  world.PlaceTarget(At(0.4, -0.1, 0.2, 0.5));
  world.AdvanceTo(101 * kMs);
  EXPECT_GT((world.truth().p_BO - by_the_scenario).norm(), 0.1);
  EXPECT_EQ(world.truth().p_BO, Eigen::Vector3d(0.4, -0.1, 0.2));
  EXPECT_EQ(world.Look().p_BO, world.truth().p_BO);
  EXPECT_TRUE(world.truth().R_BO.isApprox(At(0, 0, 0, 0.5).linear(), 1e-15));
}

}  // namespace
}  // namespace fovea::sim
