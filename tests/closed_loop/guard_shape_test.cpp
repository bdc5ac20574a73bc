// What the guard believes of the arm's shape against what it is.
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

// Its bodies are nearer than it ever lets them come, wherever the simulator's links touch.
TEST(GuardShape, NoLinksTouchInPosturesTheGuardAllows) {
  const SimRobot robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  const SelfDistance distance(robot);
  BulletArm placed(robot, {});
  const config::ServoConfig config = test::PandaConfig();
  const barriers::SolidBarriers solid(config);
  const double stops_at = solid.StopMarginOf(solid.size() - 1);  // the arm itself is the last
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
  std::cout << touching << " of 2000000 random postures touch; the guard sees at most " << 1e3 * most
            << " mm there, and stops at " << 1e3 * stops_at << " mm\n";
  EXPECT_GT(touching, 500);
}

}  // namespace
}  // namespace fovea::sim
