// SPDX-License-Identifier: Apache-2.0
// The robot behind its interface, without a network: every motion generator and every refusal.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Error;
using franka::MoveController;
using franka::MoveGenerator;
using franka::MoveStatus;
using franka::RobotCommand;
using franka::RobotMode;
using franka::RobotState;

TEST_F(FciRobotTest, IdleRobotHoldsItsPosition) {
  const RobotState first = state();
  for (int k = 0; k < 500; ++k) {
    robot().Step(std::nullopt);
  }
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
  EXPECT_EQ(state().controller_mode, franka::ControllerMode::kOther);
  EXPECT_EQ(state().message_id, first.message_id + 500);
  EXPECT_EQ(state().control_command_success_rate, 0.0);
  std::cout << "moved " << Off(state().q, first.q) << " rad, tau_ext "
            << Off(state().tau_ext_hat_filtered, {}) << " Nm\n";
  EXPECT_LT(Off(state().q, first.q), 1e-4);
  EXPECT_LT(Off(state().tau_ext_hat_filtered, {}), 0.5);
}

TEST_F(FciRobotTest, JointPositionsAreFollowedByBothImpedances) {
  for (const auto controller : {MoveController::kJointImpedance, MoveController::kCartesianImpedance}) {
    Move(controller, MoveGenerator::kJointPosition);
    franka::Vector7 goal = begin_.q_d;
    Run(1500, [&](int k, RobotCommand& c) {
      for (std::size_t i = 0; i < 7; ++i) {
        c.q_c[i] = begin_.q_d[i] + 0.2 * Fade(k, 1500);
      }
      goal = c.q_c;
    });
    std::cout << "controller " << static_cast<int>(controller) << ": off by " << Off(state().q, goal)
              << " rad\n";
    EXPECT_LT(Off(state().q_d, goal), 1e-12);
    EXPECT_LT(Off(state().q, goal), controller == MoveController::kJointImpedance ? 1e-3 : 3e-2);
    EXPECT_EQ(state().control_command_success_rate, 1.0);
    begin_.q_d = goal;
    Finish();
  }
}

TEST_F(FciRobotTest, JointVelocitiesAreFollowed) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  double way = 0.0;
  Run(1000, [&](int k, RobotCommand& c) {
    const double dq = 0.3 * (Fade(k, 300) - Fade(k - 600, 300) * (k > 600 ? 1.0 : 0.0));
    c.dq_c[0] = dq;
    way += dq * 1e-3;
  });
  std::cout << "went " << state().q[0] - begin_.q[0] << " of " << way << " rad\n";
  EXPECT_NEAR(state().q[0] - begin_.q[0], way, 1e-3);
  Finish();
}

TEST_F(FciRobotTest, PosesAreReached) {
  Move(MoveController::kJointImpedance, MoveGenerator::kCartesianPosition);
  franka::Matrix4 goal{};
  Run(1500, [&](int k, RobotCommand& c) {
    c.O_T_EE_c[12] += 0.05 * Fade(k, 1500);
    c.O_T_EE_c[14] -= 0.08 * Fade(k, 1500);
    goal = c.O_T_EE_c;
  });
  const double off =
      std::hypot(state().O_T_EE[12] - goal[12], state().O_T_EE[13] - goal[13], state().O_T_EE[14] - goal[14]);
  std::cout << "off by " << 1e3 * off << " mm\n";
  EXPECT_LT(off, 1e-3);
  EXPECT_NEAR(state().O_T_EE_c[14], goal[14], 1e-12);
  Finish();
}

TEST_F(FciRobotTest, ElbowIsMovedWhileTheHandStays) {
  Move(MoveController::kJointImpedance, MoveGenerator::kCartesianPosition);
  Run(1500, [&](int k, RobotCommand& c) {
    c.valid_elbow = 1;
    c.elbow_c = {begin_.elbow_d[0] + 0.2 * Fade(k, 1500), begin_.elbow_d[1]};
  });
  EXPECT_NEAR(state().elbow_d[0], begin_.elbow_d[0] + 0.2, 1e-9);
  EXPECT_NEAR(state().elbow[0], begin_.elbow[0] + 0.2, 1e-3);
  const double off =
      std::hypot(state().O_T_EE[12] - begin_.O_T_EE[12], state().O_T_EE[13] - begin_.O_T_EE[13],
                 state().O_T_EE[14] - begin_.O_T_EE[14]);
  std::cout << "the hand moved " << 1e3 * off << " mm\n";
  EXPECT_LT(off, 1e-3);
}

TEST_F(FciRobotTest, TwistsAreFollowed) {
  Move(MoveController::kCartesianImpedance, MoveGenerator::kCartesianVelocity);
  double way = 0.0;
  Run(1000, [&](int k, RobotCommand& c) {
    const double v = 0.1 * (Fade(k, 300) - Fade(k - 600, 300) * (k > 600 ? 1.0 : 0.0));
    c.O_dP_EE_c[1] = v;
    way += v * 1e-3;
  });
  std::cout << "went " << 1e3 * (state().O_T_EE[13] - begin_.O_T_EE[13]) << " of " << 1e3 * way << " mm\n";
  EXPECT_NEAR(state().O_T_EE[13] - begin_.O_T_EE[13], way, 2e-3);
}

TEST_F(FciRobotTest, TorqueMovesItsJointForward) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  for (int k = 1; k <= 200; ++k) {
    RobotCommand c = Still();
    c.tau_J_d = {};
    c.tau_J_d[0] = std::min(1.0, 0.5 * k);
    robot().Step(c);
    ASSERT_TRUE(robot().moving()) << Reason();
    ASSERT_EQ(state().tau_J_d, c.tau_J_d);
  }
  EXPECT_GT(state().q[0], begin_.q[0] + 0.01);
  EXPECT_GT(state().dq[0], 0.05);
  const franka::Vector7 q = state().q;
  for (int k = 0; k < 600; ++k) {
    robot().Step(Towards(q));
  }
  Finish();
  for (int k = 0; k < 500; ++k) {
    robot().Step(std::nullopt);
  }
  EXPECT_LT(Off(state().dq, {}), 5e-3) << "afterwards the robot comes to rest by itself";
}

TEST_F(FciRobotTest, NineteenLostCommandsAreBridgedAndTwentyStopTheMotion) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  robot().Step(Still());
  for (int k = 0; k < 19; ++k) {
    robot().Step(std::nullopt);
    ASSERT_TRUE(robot().moving());
  }
  RobotCommand c = Still();
  robot().Step(c);
  ASSERT_TRUE(robot().moving());
  EXPECT_DOUBLE_EQ(state().control_command_success_rate, 0.02);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(robot().moving()) << k;
    robot().Step(std::nullopt);
  }
  EXPECT_EQ(Reason(), "communication_constraints_violation");
}

TEST_F(FciRobotTest, LostCommandIsBridgedAtConstantAcceleration) {
  Move(MoveController::kJointImpedance, MoveGenerator::kJointVelocity);
  for (int k = 1; k <= 100; ++k) {
    RobotCommand c = Still();
    c.dq_c[0] = 2e-3 * k;
    robot().Step(c);
  }
  robot().Step(std::nullopt);
  robot().Step(std::nullopt);
  EXPECT_NEAR(state().dq_d[0], 0.204, 1e-12);
  EXPECT_NEAR(state().ddq_d[0], 2.0, 1e-9);
}

TEST_F(FciRobotTest, UncommandedMotionIsACommunicationError) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  for (int k = 0; k < 300; ++k) {
    robot().Step(std::nullopt);
  }
  EXPECT_EQ(Reason(), "communication_constraints_violation");
}

TEST_F(FciRobotTest, UserStopAbortsAndItsReleaseAllowsMotion) {
  Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
  robot().Step(Still());
  robot().UserStop(true);
  EXPECT_EQ(state().robot_mode, RobotMode::kUserStopped);
  EXPECT_EQ(robot().TakeMoveEnd(), MoveStatus::kEmergencyAborted);
  EXPECT_EQ(robot().Move({}), MoveStatus::kNotPossible);
  EXPECT_EQ(robot().Recover(), franka::RecoveryStatus::kEmergencyAborted);
  robot().UserStop(false);
  EXPECT_EQ(robot().Move({}), MoveStatus::kMotionStarted);
}

TEST_F(FciRobotTest, StopMovePreemptsAndAbandonReturnsToIdle) {
  EXPECT_EQ(robot().StopMove(), franka::StopStatus::kNotPossible);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
  EXPECT_EQ(robot().StopMove(), franka::StopStatus::kSuccess);
  EXPECT_EQ(robot().TakeMoveEnd(), MoveStatus::kPreempted);
  Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
  robot().Abandon();
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
  EXPECT_FALSE(robot().TakeMoveEnd().has_value());
}

TEST_F(FciRobotTest, MoveRefusesInvalidAndSecondRequests) {
  franka::MoveRequest request;
  request.controller = static_cast<MoveController>(3);
  EXPECT_EQ(robot().Move(request), MoveStatus::kInvalidArgument);
  request = {};
  request.generator = static_cast<MoveGenerator>(4);
  EXPECT_EQ(robot().Move(request), MoveStatus::kInvalidArgument);
  request = {};
  request.max_path_deviation[0] = -1.0;
  EXPECT_EQ(robot().Move(request), MoveStatus::kInvalidArgument);
  EXPECT_EQ(robot().Move({}), MoveStatus::kMotionStarted);
  EXPECT_EQ(robot().Move({}), MoveStatus::kNotPossible) << "one motion at a time";
}

TEST_F(FciRobotTest, DeviationFromThePathIsAReflex) {
  franka::MoveRequest request;
  request.controller = MoveController::kJointImpedance;
  request.generator = MoveGenerator::kJointVelocity;
  request.max_path_deviation = {1e-9, 3.0, 6.0};
  ASSERT_EQ(robot().Move(request), MoveStatus::kMotionStarted);
  robot().Step(Still());
  EXPECT_EQ(Reason(), "max_path_pose_deviation_violation");
}

TEST_F(FciRobotTest, UnreachedGoalIsAReflex) {
  franka::MoveRequest request;
  request.controller = MoveController::kJointImpedance;
  request.generator = MoveGenerator::kJointVelocity;
  request.max_goal_deviation = {1e-9, 3.0, 6.0};
  ASSERT_EQ(robot().Move(request), MoveStatus::kMotionStarted);
  RobotCommand c = Still();
  robot().Step(c);
  c.motion_generation_finished = 1;
  robot().Step(c);
  EXPECT_EQ(Reason(), "max_goal_pose_deviation_violation");
}

}  // namespace
}  // namespace fovea::test
