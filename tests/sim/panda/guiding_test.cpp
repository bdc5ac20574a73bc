// SPDX-License-Identifier: Apache-2.0
// Guiding by hand: effects of the button and of a pull.
#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Error;
using franka::MoveController;
using franka::MoveGenerator;
using franka::RecoveryStatus;
using franka::RobotMode;

class GuidingTest : public FciRobotTest {
 protected:
  explicit GuidingTest(const sim::WorldConfig& world = WirePandaWorld()) : FciRobotTest({}, world) {}

  void Allow(const std::array<std::uint8_t, 6>& axes, std::uint8_t nullspace) {
    ASSERT_EQ(
        robot().Set(franka::Command::kSetGuidingMode, franka::Bytes(franka::GuidingMode{axes, nullspace})),
        franka::SetterStatus::kSuccess);
  }
  // Guides by `force_B` for `steps`, then lets go. Returns the hand's displacement.
  franka::Vector3 Guide(const Eigen::Vector3d& force_B, int steps) {
    begin_ = state();
    robot().PressGuiding(true);
    EXPECT_EQ(state().robot_mode, RobotMode::kGuiding);
    robot().PullHand(force_B);
    Wait(steps);
    robot().PullHand(Eigen::Vector3d::Zero());
    Wait(300);  // still in guiding mode, which damps the motion
    const franka::Vector3 way = Way();
    robot().PressGuiding(false);
    std::cout << "guided by " << force_B.transpose() << " N: " << 1e3 * way[0] << ", " << 1e3 * way[1] << ", "
              << 1e3 * way[2] << " mm\n";
    return way;
  }
};

TEST_F(GuidingTest, GuidedHandFollowsThePullAndStaysThere) {
  const franka::Vector3 way = Guide({0.0, 10.0, 0.0}, 500);
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
  EXPECT_GT(way[1], 0.05);
  const franka::RobotState released = state();
  EXPECT_LT(Off(released.q_d, released.q), 1e-2) << "the desired position follows";
  Wait(500);
  EXPECT_LT(Off(state().dq, {}), 5e-3);
  EXPECT_LT(std::fabs(state().O_T_EE[13] - released.O_T_EE[13]), 0.02)
      << "the arm holds where it is released";
  EXPECT_GT(state().O_T_EE[13] - begin_.O_T_EE[13], 0.05) << "the arm does not spring back";
}

TEST_F(GuidingTest, WithoutTheButtonAPullOnlyBendsTheArm) {
  begin_ = state();
  robot().PullHand({0.0, 10.0, 0.0});
  Wait(800);
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
  EXPECT_LT(std::fabs(Way()[1]), 0.01);
}

TEST_F(GuidingTest, GuidedArmWithoutAPullStays) {
  const franka::Vector3 way = Guide({0.0, 0.0, 0.0}, 2000);
  EXPECT_LT(std::hypot(way[0], way[1], way[2]), 5e-3);
}

TEST_F(GuidingTest, LockedAxesAreHeld) {
  Allow({1, 0, 0, 0, 0, 0}, 0);
  const franka::Vector3 way = Guide({10.0, 10.0, 10.0}, 400);
  EXPECT_GT(way[0], 0.03);
  EXPECT_LT(std::fabs(way[1]), 0.01);
  EXPECT_LT(std::fabs(way[2]), 0.01);
  double turned = 0.0;
  for (std::size_t i = 0; i < 12; ++i) {
    turned = std::max(turned, std::fabs(state().O_T_EE[i] - begin_.O_T_EE[i]));
  }
  EXPECT_LT(turned, 0.02) << "the orientation is locked too";
}

// A locked hand, and a torque that pushes the elbow aside.
struct ElbowGuidingTest : GuidingTest {
  static sim::WorldConfig Pushed() {
    sim::WorldConfig config = WirePandaWorld();
    config.push.tau = Eigen::VectorXd::Zero(7);
    config.push.tau[2] = 2.0;
    config.push.window = {0, hal::kNsPerSecond};
    return config;
  }
  ElbowGuidingTest() : GuidingTest(Pushed()) {}

  double ElbowWay(std::uint8_t nullspace) {
    Allow({0, 0, 0, 0, 0, 0}, nullspace);
    begin_ = state();
    robot().PressGuiding(true);
    Wait(500);
    const franka::Vector3 way = Way();
    EXPECT_LT(std::hypot(way[0], way[1], way[2]), 0.01) << "the hand is locked";
    return std::fabs(state().elbow[0] - begin_.elbow[0]);
  }
};

TEST_F(ElbowGuidingTest, FreeElbowFollowsThePull) {
  const double way = ElbowWay(1);
  std::cout << "joint 3 moved by " << way << " rad\n";
  EXPECT_GT(way, 0.1);
}

TEST_F(ElbowGuidingTest, LockedElbowIsHeld) {
  const double way = ElbowWay(0);
  std::cout << "joint 3 moved by " << way << " rad\n";
  EXPECT_LT(way, 0.1);
}

TEST_F(GuidingTest, GuidingRefusesMotionAndRecovery) {
  robot().PressGuiding(true);
  EXPECT_EQ(robot().Move({}), franka::MoveStatus::kNotPossible);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kNotPossible);
  robot().UserStop(true);
  EXPECT_EQ(state().robot_mode, RobotMode::kUserStopped);
  robot().PressGuiding(false);
  EXPECT_EQ(state().robot_mode, RobotMode::kUserStopped);
}

TEST_F(GuidingTest, ButtonDuringAMotionHasNoEffect) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  robot().PressGuiding(true);
  EXPECT_EQ(state().robot_mode, RobotMode::kMove);
}

TEST_F(GuidingTest, StoppedRobotCanBeGuidedAndIsStoppedAfterwards) {
  robot().UserStop(true);
  EXPECT_GT(Guide({0.0, 10.0, 0.0}, 400)[1], 0.03);
  EXPECT_EQ(state().robot_mode, RobotMode::kUserStopped);
  robot().PressGuiding(true);
  robot().UserStop(false);
  robot().PressGuiding(false);
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
}

TEST_F(GuidingTest, GuidingTooFastIsAReflex) {
  robot().PressGuiding(true);
  robot().PullHand({0.0, 150.0, 0.0});
  Wait(500);
  EXPECT_EQ(state().robot_mode, RobotMode::kReflex);
  EXPECT_EQ(state().errors[static_cast<std::size_t>(Error::kJointVelocity)] +
                state().errors[static_cast<std::size_t>(Error::kCartesianVelocity)],
            1);
}

// An arm whose joint 4 is 5 mrad past its end: guided further out it stops again, guided inwards it recovers.
struct OutOfRangeGuidingTest : GuidingTest {
  // Pulls by `force_B` until the robot leaves guiding, for at most `steps`.
  void Pull(const Eigen::Vector3d& force_B, int steps) {
    robot().PressGuiding(true);
    robot().PullHand(force_B);
    for (int k = 0; k < steps && state().robot_mode == RobotMode::kGuiding; ++k) {
      Wait(1);
    }
    robot().PullHand(Eigen::Vector3d::Zero());
    robot().PressGuiding(false);
    Wait(300);
  }
};

TEST_F(OutOfRangeGuidingTest, OutwardGuidingIsAnErrorAndInwardGuidingRecovers) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  RunUntilItStops(4000, [&](int k) {
    franka::Vector7 goal = begin_.q;
    goal[3] -= 5e-4 * k;
    return Towards(goal);
  });
  ExpectReflex(Error::kJointPositionLimits);
  ASSERT_EQ(robot().Recover(), RecoveryStatus::kManualRecoveryRequired);
  const double outside = state().q[3];
  Pull({-30.0, 0.0, 0.0}, 3000);  // towards the base: the elbow bends
  std::cout << "from " << outside << " to " << state().q[3] << " rad: " << Reason() << '\n';
  EXPECT_EQ(state().errors[static_cast<std::size_t>(Error::kJointMoveInWrongDirection)], 1);
  EXPECT_EQ(state().robot_mode, RobotMode::kReflex);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kManualRecoveryRequired);
  Pull({30.0, 0.0, 0.0}, 300);
  EXPECT_GT(state().q[3], -3.0718);
  EXPECT_EQ(robot().Recover(), RecoveryStatus::kSuccess);
  EXPECT_EQ(state().errors, franka::ErrorFlags{});
}

TEST_F(OutOfRangeGuidingTest, GuidingPastAJointEndIsAReflex) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
  Run(2000, [&](int k, franka::RobotCommand& c) { c.q_c[3] -= 0.85 * Fade(k, 2000); });
  begin_.q_d = state().q_d;
  Finish();
  ASSERT_GT(state().q[3], -3.0718);
  Pull({-30.0, 0.0, 0.0}, 3000);
  EXPECT_EQ(state().errors, OnlyFlag(Error::kJointPositionLimits));
  EXPECT_LT(state().q[3], -3.0718);
  EXPECT_EQ(state().robot_mode, RobotMode::kReflex);
}

}  // namespace
}  // namespace fovea::test
