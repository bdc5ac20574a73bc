// SPDX-License-Identifier: Apache-2.0
// Events that end a motion or prevent its start: the reported reason, and the recovery.
#include "tests/hal/drivers/franka/franka_arm_fixture.hpp"

namespace fovea::test {
namespace {

TEST_F(FrankaArmTest, ReflexStopsUntilRecoveryAndRestartIsWithoutAStep) {
  Start();
  ASSERT_TRUE(Write(0.5).ok());
  ASSERT_TRUE(robot_.TakeCommand().has_value());
  robot_.ShowReflex(franka::Error::kCommunicationConstraints);
  robot_.AnswerStatus(move_, 6);
  hal::Status status = Next();
  EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
  EXPECT_STREQ(status.where(), "communication_constraints_violation");
  EXPECT_EQ(Write(5.0).code(), StatusCode::kDeviceFault);
  EXPECT_EQ(Next().code(), StatusCode::kDeviceFault);
  EXPECT_FALSE(robot_.TakeCommand(20ms).has_value()) << "nothing is sent to a stopped robot";

  arm_->AskRecovery();
  EXPECT_EQ(Next().code(), StatusCode::kDeviceFault);
  const auto recovery = robot_.Take();
  ASSERT_TRUE(recovery.has_value());
  EXPECT_EQ(recovery->header.command, franka::Command::kAutomaticErrorRecovery);
  robot_.AnswerStatus(*recovery, 0);
  std::this_thread::sleep_for(5ms);
  EXPECT_TRUE(Next().ok()) << "an old state may arrive after the answer";
  robot_.state.errors = {};
  robot_.ShowIdle();
  robot_.state.tau_J_d[0] = 2.0;
  EXPECT_TRUE(Next().ok());
  EXPECT_EQ(arm_->phase(), MotionPhase::kIdle);

  ASSERT_TRUE(Write(5.0).ok());
  EXPECT_EQ(arm_->counters().motions, 1U) << "a command of the ended motion starts no new one";
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, /*brakes=*/true).ok());
  Start();
  ASSERT_TRUE(Write(-8.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 1.0) << "one step from the applied 2 Nm";
}

// The answer to a refused recovery is reported before any other reason.
TEST_F(FrankaArmTest, ManualRecoveryIsReportedUntilItIsDone) {
  for (const auto& [answer, says] : {std::pair{2, "the robot needs a person to recover it"},
                                     std::pair{1, "the robot cannot recover now"}}) {
    SCOPED_TRACE(says);
    Start();
    robot_.ShowReflex(franka::Error::kJointPositionLimits);
    EXPECT_STREQ(Next().where(), "joint_position_limits_violation");
    AskRecovery(answer);
    for (int k = 0; k < 3; ++k) {
      EXPECT_STREQ(Next().where(), says);
    }
    // A person moved the arm back by hand.
    robot_.state.errors = {};
    robot_.ShowIdle();
    EXPECT_STREQ(Next().where(), says) << "until recovery is requested again";
    AskRecovery(0);
    EXPECT_TRUE(Next().ok());
  }
}

TEST_F(FrankaArmTest, RefusedOrAbortedMotionReportsTheReason) {
  const struct {
    int answer;
    const char* says;
  } kRows[]{{2, "another motion replaced it"},
            {3, "the robot cannot move now"},
            {4, "the start pose is singular"},
            {5, "the robot refuses the motion's arguments"},
            {7, "user stop"},
            {9, "the robot aborted the motion"}};
  for (const auto& row : kRows) {
    Start();
    robot_.ShowIdle();
    robot_.AnswerStatus(move_, row.answer);
    std::this_thread::sleep_for(5ms);
    const hal::Status status = Next();
    EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
    EXPECT_STREQ(status.where(), row.says);
    AskRecovery(0);
    EXPECT_TRUE(Next().ok());
  }
}

TEST_F(FrankaArmTest, RobotLeavingTheMotionIsADeviceFault) {
  Start();
  robot_.ShowIdle();
  const hal::Status status = Next();
  EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
  EXPECT_STREQ(status.where(), "the robot ended the motion");
}

TEST_F(FrankaArmTest, UserStopIsReported) {
  Start();
  robot_.ShowIdle();
  robot_.state.robot_mode = franka::RobotMode::kUserStopped;
  const hal::Status status = Next();
  EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
  EXPECT_STREQ(status.where(), "user stop");
}

TEST_F(FrankaArmTest, RefusedMoveIsReported) {
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0).ok());
  robot_.AnswerStatus(*robot_.Take(), 3);
  std::this_thread::sleep_for(5ms);
  const hal::Status status = Next();
  EXPECT_EQ(status.code(), StatusCode::kDeviceFault);
  EXPECT_STREQ(status.where(), "the robot cannot move now");
}

TEST_F(FrankaArmTest, MoveThatNeverStartsIsAFault) {
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0).ok());
  hal::Status status = hal::Status::Ok();
  int states = 0;
  for (; states < 1000 && status.ok(); ++states) {
    status = Next();
  }
  EXPECT_EQ(states, 501);
  EXPECT_STREQ(status.where(), "the robot does not start the motion");
}

}  // namespace
}  // namespace fovea::test
