// SPDX-License-Identifier: Apache-2.0
// Compares the guard's model of the arm's shape with the simulator's links.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "sim/panda/self_distance.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

// Wherever the simulator's links touch, the guard's bodies are closer than the guard ever lets them come.
TEST(GuardShape, NoLinksTouchInPosturesTheGuardAllows) {
  const SimRobot robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  const SelfDistance distance(robot);
  BulletArm placed(robot, {});
  const config::ServoConfig config = test::PandaConfig();
  const barriers::SolidBarriers solid(config);
  const double stops_at = solid.StopMarginOf(solid.size() - 1);  // the last barrier: the arm against itself
  test::RandomStates random(20261125);
  std::vector<Eigen::Isometry3d> X_BL(robot.links.size());
  int touching = 0;
  double most = 0.0;
  for (int k = 0; k < 2'000'000; ++k) {
    const model::VecN q = random.Position(config.arm);
    placed.SetState(q, Eigen::VectorXd::Zero(7));
    for (std::size_t i = 0; i < X_BL.size(); ++i) {
      X_BL[i] = placed.LinkPose(static_cast<int>(i));
    }
    if (distance.Least(X_BL) >= 0.0) {
      continue;
    }
    ++touching;
    model::ArmPoses poses;
    model::ComputePoses(config.arm, q, poses);
    const double clearance = barriers::SelfClearance(config.arm, barriers::PlaceBodies(config.arm, poses));
    most = std::max(most, clearance);
    EXPECT_LT(clearance, stops_at) << "at " << q.transpose();
  }
  std::cout << touching << " of 2000000 random postures touch; the guard's clearance there is at most "
            << 1e3 * most << " mm, and it stops at " << 1e3 * stops_at << " mm\n";
  EXPECT_GT(touching, 500);
}

}  // namespace
}  // namespace fovea::sim
