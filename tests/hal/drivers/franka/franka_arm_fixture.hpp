// SPDX-License-Identifier: Apache-2.0
// The driver connected to a robot that the test controls.
#pragma once

#include <gmock/gmock.h>

#include <memory>

#include "tests/hal/drivers/franka/fake_robot.hpp"

namespace fovea::test {

using franka::MotionPhase;
using hal::StatusCode;

class FrankaArmTest : public testing::Test {
 protected:
  void SetUp() override { Connect(ConfigFor(robot_)); }

  void Connect(const franka::FrankaConfig& config) {
    std::jthread other([this] { EXPECT_TRUE(robot_.ServeSetUp()); });
    arm_ = std::make_unique<franka::FrankaArm>(config, &clock_);
  }

  // The robot sends a state and the driver reads it.
  hal::Status Next() {
    robot_.SendState();
    return arm_->Read(state_);
  }
  [[nodiscard]] hal::Status Write(double tau, bool brakes = false) {
    hal::ArmCommand command;
    command.num_joints = 7;
    command.tau_cmd[0] = tau;
    command.engage_brakes = brakes;
    return arm_->Write(command);
  }
  // Starts a motion: Move is requested, answered and shown in the state.
  void Start() {
    EXPECT_TRUE(Next().ok());
    EXPECT_TRUE(Write(0.0).ok());
    const auto move = robot_.Take();
    ASSERT_TRUE(move.has_value());
    ASSERT_EQ(move->header.command, franka::Command::kMove);
    move_ = *move;
    robot_.AnswerStatus(move_, 1);
    robot_.ShowMove();
    EXPECT_TRUE(Next().ok());
    ASSERT_EQ(arm_->phase(), MotionPhase::kRunning);
  }

  // Engages the brakes, requests recovery and lets the robot's answer arrive.
  void AskRecovery(int answer) {
    static_cast<void>(Write(0.0, /*brakes=*/true));
    arm_->AskRecovery();
    EXPECT_EQ(Next().code(), StatusCode::kDeviceFault);
    robot_.AnswerStatus(*robot_.Take(), answer);
    std::this_thread::sleep_for(5ms);
  }

  FakeRobot robot_;
  franka::RobotClock clock_;
  std::unique_ptr<franka::FrankaArm> arm_;
  hal::ArmState state_;
  FakeRobot::Request move_;
};

}  // namespace fovea::test
