// SPDX-License-Identifier: Apache-2.0
// Every error caused by the arm's measured behaviour, at the robot's interface without a network.
#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Error;
using franka::MoveController;
using franka::MoveGenerator;
using franka::RecoveryStatus;
using franka::RobotCommand;
using franka::RobotMode;

TEST_F(FciRobotTest, TorqueMotionPastAJointRangeNeedsManualRecovery) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  RunUntilItStops(4000, [&](int k) {
    franka::Vector7 goal = begin_.q;
    goal[3] -= 5e-4 * k;
    return Towards(goal);
  });
  ExpectReflex(Error::kJointPositionLimits);
  EXPECT_LT(state().q[3], -3.0718);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kManualRecoveryRequired);
}

TEST_F(FciRobotTest, TooFastHandIsAReflex) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  // Joints 1 and 7 turn the hand together, each within its own limit.
  RunUntilItStops(2000, [&](int k) {
    franka::Vector7 goal = begin_.q;
    const double turn = 3e-6 * k * k;  // an acceleration of 6 rad/s^2
    goal[0] += turn;
    goal[6] -= turn;
    return Towards(goal);
  });
  ExpectReflex(Error::kCartesianVelocity);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
}

TEST_F(FciRobotTest, PullAboveTheJointThresholdIsAJointReflex) {
  SetCollisionsFrom(15.0, 1e3);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  robot().PullHand({0.0, 60.0, 0.0});
  RunUntilItStops(1000, [&](int) { return Still(); });
  EXPECT_NE(state().joint_collision, franka::Vector7{});
  EXPECT_EQ(state().cartesian_collision, franka::Vector6{});
  ExpectReflex(Error::kJointReflex);
  robot().PullHand({0.0, 0.0, 0.0});
  Wait(500);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
}

TEST_F(FciRobotTest, PullAboveOnlyTheCartesianThresholdIsACartesianReflex) {
  SetCollisionsFrom(100.0, 20.0);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  robot().PullHand({0.0, 0.0, -30.0});
  RunUntilItStops(1000, [&](int) { return Still(); });
  EXPECT_EQ(state().cartesian_collision[2], 1.0) << "the hand points down: K's z is opposite to B's";
  ExpectReflex(Error::kCartesianReflex);
}

TEST_F(FciRobotTest, PullBelowTheCollisionThresholdIsShownAsAContact) {
  SetCollisionsFrom(100.0, 100.0);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  robot().PullHand({0.0, 60.0, 0.0});
  RunUntilItStops(500, [&](int) { return Still(); });
  EXPECT_TRUE(robot().moving()) << Reason();
  EXPECT_EQ(state().joint_contact[0], 1.0);
  EXPECT_EQ(state().joint_collision[0], 0.0);
  EXPECT_EQ(state().cartesian_contact[1], 1.0);
  EXPECT_EQ(state().cartesian_contact[2], 0.0);
  EXPECT_EQ(state().cartesian_collision, franka::Vector6{});
  std::cout << "a pull of 60 N is felt as " << state().O_F_ext_hat_K[1] << " N\n";
  EXPECT_NEAR(state().O_F_ext_hat_K[1], 60.0, 1.0);
}

TEST_F(FciRobotTest, TorqueAboveTheJointRangeIsAReflex) {
  SetCollisionsFrom(1e3, 1e3);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  RunUntilItStops(3000, [&](int k) {
    robot().PullHand({0.0, 0.0, -0.1 * k});  // an increasing pull
    return Still();
  });
  ExpectReflex(Error::kTauJRange);
}

TEST_F(FciRobotTest, UnstableControlLoopIsAReflex) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  RunUntilItStops(3000, [&](int k) {
    RobotCommand c = Towards(begin_.q);
    // An undamped spring, so stiff that a delay of 1 ms makes it unstable; the torque saturates at 1.5 Nm.
    const double goal = begin_.q[6] + (k > 10 ? 0.002 : 0.0);
    const double wish = std::clamp(600.0 * (goal - state().q[6]), -1.5, 1.5);
    c.tau_J_d[6] = state().tau_J_d[6] + std::clamp(wish - state().tau_J_d[6], -1.0, 1.0);
    return c;
  });
  ExpectReflex(Error::kInstabilityDetection);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
}

TEST_F(FciRobotTest, StopsBeforeItMeetsItself) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
  const franka::Vector7 folded{0.0, 0.634, 0.530, -2.946, 0.113, 0.627, 0.7};
  RunUntilItStops(4000, [&](int k) {
    RobotCommand c = Still();
    for (std::size_t i = 0; i < folded.size(); ++i) {
      c.q_c[i] += Fade(k, 3000) * (folded[i] - begin_.q_d[i]);
    }
    return c;
  });
  ExpectReflex(Error::kSelfCollisionAvoidance);
  const sim::WorldConfig config = WirePandaWorld();
  const sim::Chain chain(config.robot);
  const double gap = sim::SelfDistance(config.robot).Least(chain.LinkPoses(sim::ToVector(state().q)));
  std::cout << "stands with a gap of " << 1e3 * gap << " mm\n";
  EXPECT_GT(gap, 0.0);
  // A motion away from the collision is allowed.
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
  Run(2000, [&](int k, RobotCommand& c) { c.q_c[3] += 0.5 * Fade(k, 2000); });
}

// A wall 5 cm to the left of the hand.
struct VirtualWallTest : FciRobotTest {
  static sim::CartesianWall Wall() {
    sim::CartesianWall wall;
    wall.X_BW.translation() = Eigen::Vector3d(0.1, 0.05, 0.3);
    wall.size = {0.6, 0.5, 0.6};
    return wall;
  }
  VirtualWallTest() : FciRobotTest({Wall()}) {}
};

TEST_F(VirtualWallTest, RobotStopsAtAWall) {
  ASSERT_TRUE(robot().Wall(0).has_value());
  EXPECT_FALSE(robot().Wall(1).has_value());
  EXPECT_FALSE(robot().Wall(-1).has_value());
  Move(MoveController::kJointImpedance, MoveGenerator::kCartesianVelocity);
  RunUntilItStops(3000, [&](int k) {
    RobotCommand c = Still();
    c.O_dP_EE_c[1] = 0.1 * Fade(k, 300);
    return c;
  });
  EXPECT_NEAR(state().O_T_EE[13], 0.05, 1e-3);
  ExpectReflex(Error::kCartesianPositionLimits);
  // The hand is inside the wall: a person must guide it out.
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kManualRecoveryRequired);
  robot().PressGuiding(true);
  robot().PullHand({0.0, -15.0, 0.0});
  for (int k = 0; k < 2000 && state().O_T_EE[13] > 0.04; ++k) {
    Wait(1);
  }
  robot().PullHand({0.0, 0.0, 0.0});
  robot().PressGuiding(false);
  EXPECT_EQ(state().robot_mode, RobotMode::kReflex);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
}

}  // namespace
}  // namespace fovea::test
