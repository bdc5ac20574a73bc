// SPDX-License-Identifier: Apache-2.0
// What the arm can run into: each gradient against differences of its value; the table is complete.
#include "firmware/core/barriers/solid_barriers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;
using model::VecN;

config::ServoConfig Crowded() {
  config::ServoConfig config = test::PandaConfig();
  config::Obstacles& obstacles = config.guard.obstacles;
  obstacles.num_planes = 2;
  obstacles.planes[0] = {Vec3(0.0, 0.0, 1.0), 0.1};
  obstacles.planes[1] = {Vec3(-0.6, 0.0, -0.8), -0.7};
  obstacles.num_boxes = 1;
  obstacles.boxes[0] = {Vec3(0.3, -0.2, 0.0), Vec3(0.5, 0.2, 0.3)};
  EXPECT_TRUE(config.guard.hand.AddCapsule(Vec3::Zero(), Vec3(0.05, 0.0, 0.04), 0.03));
  config.guard.self_clearance = 0.02;
  return config;
}

struct Posture {
  Posture(const config::ServoConfig& config, const VecN& q) {
    model::ComputePoses(config.arm, q, poses);
    bodies = PlaceBodies(config.arm, poses);
    model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
  }
  model::ArmPoses poses;
  ArmBodies bodies;
  model::LinearJacobian J_E_B;
};

TEST(SolidBarriersTest, GradientsMatchFiniteDifferencesOfTheirValues) {
  const config::ServoConfig config = Crowded();
  const SolidBarriers solid(config);
  ASSERT_EQ(solid.size(), 1 + 3 + 2 + 1);
  EXPECT_EQ(solid.NameOf(0), hal::Limit::kWorkspace);
  test::RandomStates random(91);
  // An axis of a link inside the box: its nearest face may change from one side of the difference to the
  // other.
  constexpr double kThinnest = 0.035;  // radius of a link [m]
  double worst = 0.0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = random.Position(config.arm);
    const VecN dq = random.Joints(config.arm, 0.5);
    const Posture now(config, q);
    constexpr double kDt = 1e-7;
    const Posture before(config, q - kDt * dq);
    const Posture after(config, q + kDt * dq);
    for (int i = 0; i < solid.size(); ++i) {
      const Barrier row = solid.RowOf(i, {now.poses, now.bodies, now.J_E_B, dq});
      EXPECT_EQ(row.value, solid.ValueOf(i, now.poses, now.bodies));
      EXPECT_EQ(row.name, solid.NameOf(i));
      if (i == 5 && row.value < -kThinnest) {
        continue;
      }
      EXPECT_GE(row.margin, solid.StopMarginOf(i)) << "the row must act before the proof of a stop";
      const double rate =
          (solid.ValueOf(i, after.poses, after.bodies) - solid.ValueOf(i, before.poses, before.bodies)) /
          (2.0 * kDt);
      worst = std::max(worst, std::abs(row.gradient.dot(dq) - rate));
    }
  }
  std::cout << "off by at most " << worst << " m/s\n";
  EXPECT_LT(worst, 1e-7);
}

TEST(SolidBarriersTest, UnconfiguredBarriersAreNotInTheTable) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.obstacles = {};
  config.guard.self_clearance = 0.0;
  EXPECT_EQ(SolidBarriers(config).size(), 1);
  config::Obstacles& obstacles = config.guard.obstacles;
  obstacles.num_planes = obstacles.num_boxes = config::Obstacles::kMost;
  config.guard.self_clearance = 0.1;
  EXPECT_EQ(SolidBarriers(config).size(), SolidBarriers::kMost);
}

TEST(SolidBarriersTest, ArmClearanceIsTheSmallestOfHandAndLinks) {
  const config::ServoConfig config = Crowded();
  const SolidBarriers solid(config);
  test::RandomStates random(92);
  for (int k = 0; k < 100; ++k) {
    const Posture at(config, random.Position(config.arm));
    double least = HUGE_VAL;
    for (int i = 1; i < 6; ++i) {
      least = std::min(least, solid.ValueOf(i, at.poses, at.bodies));
    }
    EXPECT_EQ(ClearanceOfArm(config, at.poses), least);
  }
  config::ServoConfig alone = config;
  alone.guard.obstacles = {};
  EXPECT_EQ(ClearanceOfArm(alone, Posture(config, test::Ready()).poses), HUGE_VAL);
}

}  // namespace
}  // namespace fovea::barriers
