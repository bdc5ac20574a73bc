// SPDX-License-Identifier: Apache-2.0
// The driver in the control loop, connected to a robot that the test controls.
#include <algorithm>

#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "tests/hal/drivers/franka/franka_arm_fixture.hpp"

namespace fovea::test {
namespace {

TEST_F(FrankaArmTest, StateIsPassedOnUnchanged) {
  for (std::size_t i = 0; i < 7; ++i) {
    const auto k = static_cast<double>(i);
    robot_.state.q[i] = 0.1 + k;
    robot_.state.dq[i] = 0.2 + k;
    robot_.state.tau_J[i] = 0.3 + k;
    robot_.state.tau_J_d[i] = 0.4 + k;
  }
  ASSERT_TRUE(Next().ok());
  EXPECT_EQ(state_.num_joints, 7);
  EXPECT_EQ(state_.sequence, 1001U);
  EXPECT_EQ(state_.stamp_ns, 1001 * hal::kNsPerMs);
  EXPECT_EQ(clock_.NowNs(), state_.stamp_ns);
  for (std::size_t i = 0; i < 7; ++i) {  // no joint is swapped
    const auto k = static_cast<double>(i);
    EXPECT_EQ(state_.q[i], 0.1 + k);
    EXPECT_EQ(state_.dq[i], 0.2 + k);
    EXPECT_EQ(state_.tau_meas[i], 0.3 + k);
    EXPECT_EQ(state_.tau_applied[i], 0.4 + k);
  }
  EXPECT_EQ(state_.q[7], 0.0);
}

// The first read waits for the whole time-out; then the loop stays responsive.
TEST_F(FrankaArmTest, SilentRobotIsWaitedForOnlyOnce) {
  franka::FrankaConfig config = ConfigFor(robot_);
  config.state_timeout_ns = hal::kNsPerSecond;
  arm_.reset();
  Connect(config);
  ASSERT_TRUE(Next().ok());
  std::array<std::int64_t, 5> waited_ns{};
  for (std::int64_t& waited : waited_ns) {
    --robot_.state.message_id;  // the same state again
    const std::int64_t begin_ns = linux_rt::MonotonicNs();
    EXPECT_EQ(Next().code(), StatusCode::kTimeout);
    waited = linux_rt::MonotonicNs() - begin_ns;
  }
  EXPECT_GE(waited_ns[0], hal::kNsPerSecond);
  EXPECT_LT(*std::min_element(waited_ns.begin() + 1, waited_ns.end()), hal::kNsPerSecond / 2);
  EXPECT_TRUE(Next().ok()) << "it continues";
}

TEST_F(FrankaArmTest, MoveIsSentOnceAndEachStateAnsweredOnce) {
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.5).ok());
  EXPECT_EQ(arm_->phase(), MotionPhase::kStarting);
  const auto move = robot_.Take();
  ASSERT_TRUE(move.has_value());
  franka::MoveRequest request;
  ASSERT_TRUE(franka::Decode(move->payload, request));
  EXPECT_EQ(request.controller, franka::MoveController::kExternal);
  EXPECT_EQ(request.generator, franka::MoveGenerator::kJointVelocity);
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.5).ok());
  EXPECT_FALSE(robot_.TakeCommand(20ms).has_value()) << "the motion has not started";
  robot_.AnswerStatus(*move, 1);
  robot_.ShowMove();
  for (int k = 0; k < 5; ++k) {
    const std::uint64_t id = robot_.state.message_id;
    ASSERT_TRUE(Next().ok());
    ASSERT_TRUE(Write(0.5).ok());
    const auto command = robot_.TakeCommand();
    ASSERT_TRUE(command.has_value());
    EXPECT_EQ(command->message_id, id);
    EXPECT_EQ(command->tau_J_d[0], 0.5);
    EXPECT_EQ(command->dq_c, franka::Vector7{});
    EXPECT_EQ(command->motion_generation_finished, 0);
  }
  EXPECT_FALSE(robot_.TakeCommand(20ms).has_value()) << "one command for one state";
  EXPECT_EQ(arm_->counters().commands, 5U);
  EXPECT_EQ(arm_->counters().motions, 1U);
  EXPECT_EQ(arm_->counters().repeated_commands, 0U);
}

TEST_F(FrankaArmTest, TorqueRateStartsFromTheAppliedTorque) {
  Start();
  ASSERT_TRUE(Write(10.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 1.0);
  // The command was lost: the robot still applies 0.
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(10.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 1.0);
  robot_.state.tau_J_d[0] = 1.0;
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(10.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 2.0);
  // The applied torque matches no command: the next one stays near it and near the commands not applied yet.
  robot_.state.tau_J_d[0] = 1.5;
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(10.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 2.0);
  EXPECT_EQ(arm_->counters().rate_limited, 4U);
}

TEST_F(FrankaArmTest, StateWithoutACommandIsAnsweredWithTheLastOne) {
  Start();
  ASSERT_TRUE(Write(0.5).ok());
  EXPECT_EQ(robot_.TakeCommand()->tau_J_d[0], 0.5);
  ASSERT_TRUE(Next().ok());
  const std::uint64_t open = robot_.state.message_id - 1;
  ASSERT_TRUE(Next().ok());  // without a Write in between
  const auto command = robot_.TakeCommand();
  ASSERT_TRUE(command.has_value());
  EXPECT_EQ(command->message_id, open);
  EXPECT_EQ(command->tau_J_d[0], 0.5);
  EXPECT_EQ(arm_->counters().repeated_commands, 1U);
}

TEST_F(FrankaArmTest, LostLateRepeatedShortAndForeignDatagramsAreCounted) {
  robot_.state.message_id += 3;
  ASSERT_TRUE(Next().ok());
  EXPECT_EQ(arm_->counters().lost_states, 3U);
  const std::uint64_t newest = robot_.state.message_id - 1;
  robot_.state.message_id = newest - 2;
  robot_.SendState();  // late
  robot_.state.message_id = newest;
  robot_.SendState();                                              // again
  robot_.SendDatagram(std::vector<std::byte>(2372, std::byte{}));  // short
  robot_.SendDatagram(std::vector<std::byte>(2374, std::byte{}));  // long
  robot_.SendDatagram({});                                         // empty
  robot_.state.message_id = std::uint64_t{1} << 60U;               // a time out of range
  robot_.SendState();
  robot_.state.message_id = newest + 1;
  robot_.SendState();
  robot_.SendState();  // the second of two new states
  ASSERT_TRUE(arm_->Read(state_).ok());
  EXPECT_EQ(state_.sequence, newest + 2);
  const franka::FrankaCounters& c = arm_->counters();
  EXPECT_EQ(c.late_states, 1U);
  EXPECT_EQ(c.duplicate_states, 1U);
  EXPECT_EQ(c.malformed, 4U);
  EXPECT_EQ(c.skipped_states, 1U);
  EXPECT_EQ(c.states, 3U);
}

// A state from another address must not be used.
TEST_F(FrankaArmTest, StateFromAnotherAddressIsIgnoredAndCounted) {
  ASSERT_TRUE(Next().ok());
  const std::uint64_t newest = robot_.state.message_id - 1;
  robot_.SendForeignState(100);
  EXPECT_EQ(arm_->Read(state_).code(), StatusCode::kTimeout);
  EXPECT_EQ(state_.sequence, newest);
  EXPECT_EQ(arm_->counters().foreign, 1U);
}

TEST_F(FrankaArmTest, SilenceTimesOutAndKeepsTheState) {
  ASSERT_TRUE(Next().ok());
  const hal::ArmState before = state_;
  EXPECT_EQ(arm_->Read(state_).code(), StatusCode::kTimeout);
  EXPECT_EQ(state_.sequence, before.sequence);
  EXPECT_EQ(arm_->counters().timeouts, 1U);
  EXPECT_TRUE(Next().ok()) << "the next state is read again";
}

TEST_F(FrankaArmTest, ClosedConnectionIsReportedAsDisconnected) {
  Start();
  robot_.Close();
  hal::Status status = hal::Status::Ok();
  for (int k = 0; k < 20 && status.code() != StatusCode::kDisconnected; ++k) {
    status = arm_->Read(state_);
  }
  EXPECT_EQ(status.code(), StatusCode::kDisconnected);
  EXPECT_STREQ(status.where(), "the robot closed the connection");
  EXPECT_EQ(Write(0.0).code(), StatusCode::kDisconnected);
}

TEST_F(FrankaArmTest, GarbageDuringAMotionEndsTheConnection) {
  Start();
  robot_.SendRaw(std::vector<std::byte>(20, std::byte{0xFF}));
  hal::Status status = hal::Status::Ok();
  for (int k = 0; k < 20 && status.code() != StatusCode::kDisconnected; ++k) {
    status = arm_->Read(state_);
  }
  EXPECT_STREQ(status.where(), "the robot sent an invalid message");
}

// A message with an impossible length is refused at once; the driver does not wait for its end.
TEST_F(FrankaArmTest, TooLongMessageEndsTheConnection) {
  Start();
  franka::Header header;
  header.command = franka::Command::kMove;
  header.size = 5000;
  const auto bytes = franka::Bytes(header);
  robot_.SendRaw({bytes.begin(), bytes.end()});
  hal::Status status = hal::Status::Ok();
  for (int k = 0; k < 20 && status.code() != StatusCode::kDisconnected; ++k) {
    status = arm_->Read(state_);
  }
  EXPECT_STREQ(status.where(), "the robot sent an invalid message");
}

TEST_F(FrankaArmTest, BrakingFinishesTheMotionAndReleaseStartsANewOne) {
  Start();
  ASSERT_TRUE(Write(0.5).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 0);
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, /*brakes=*/true).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 1);
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, true).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 1) << "repeated until the states show the end";
  robot_.ShowIdle();
  robot_.AnswerStatus(move_, 0);
  ASSERT_TRUE(Next().ok());
  EXPECT_EQ(arm_->phase(), MotionPhase::kIdle);
  ASSERT_TRUE(Write(0.0, true).ok());
  EXPECT_FALSE(robot_.TakeCommand(20ms).has_value());
  Start();
  EXPECT_EQ(arm_->counters().motions, 2U);
}

// A robot reports a fault of the client if a motion ends at speed.
TEST_F(FrankaArmTest, MovingArmIsSlowedDownBeforeItsMotionIsFinished) {
  Start();
  ASSERT_TRUE(Write(0.0).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 0);
  robot_.state.dq = {0.5, 0.0, 0.0, -0.3, 0.0, 0.0, 0.0};
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, /*brakes=*/true).ok());
  auto command = robot_.TakeCommand();
  ASSERT_TRUE(command.has_value());
  EXPECT_EQ(command->motion_generation_finished, 0);
  EXPECT_LT(command->tau_J_d[0], 0.0) << "against the motion";
  EXPECT_GT(command->tau_J_d[3], 0.0);
  EXPECT_EQ(command->tau_J_d[1], 0.0);
  robot_.state.dq = {0.015, 0.0, 0.0, -0.015, 0.0, 0.0, 0.0};
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, true).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 1) << "the arm is at rest";
  robot_.state.dq[0] = 0.1;  // any later movement is the robot's own
  ASSERT_TRUE(Next().ok());
  ASSERT_TRUE(Write(0.0, true).ok());
  EXPECT_EQ(robot_.TakeCommand()->motion_generation_finished, 1) << "finished is not withdrawn";
}

TEST_F(FrankaArmTest, ArmThatNeverRestsIsFinishedAfterHalfASecond) {
  Start();
  ASSERT_TRUE(Write(0.0).ok());
  ASSERT_TRUE(robot_.TakeCommand().has_value());
  robot_.state.dq[0] = 0.5;
  int braked = 0;
  for (bool finished = false; !finished && braked < 1000;) {
    ASSERT_TRUE(Next().ok());
    ASSERT_TRUE(Write(0.0, /*brakes=*/true).ok());
    finished = robot_.TakeCommand()->motion_generation_finished == 1;
    braked += finished ? 0 : 1;
  }
  EXPECT_EQ(braked, 500);
}

TEST_F(FrankaArmTest, StopFinishesTheMotionAndDisconnects) {
  Start();
  std::jthread other([this] {
    for (int k = 0; k < 200; ++k) {
      const auto command = robot_.TakeCommand(100ms);
      if (command && command->motion_generation_finished == 1) {
        robot_.ShowIdle();
        robot_.AnswerStatus(move_, 0);
        robot_.SendState();
        return;
      }
      robot_.SendState();
    }
    ADD_FAILURE() << "the driver never finished the motion";
  });
  arm_->Stop();
  EXPECT_EQ(arm_->phase(), MotionPhase::kIdle);
  EXPECT_EQ(arm_->Read(state_).code(), StatusCode::kDisconnected);
}

TEST_F(FrankaArmTest, ReadAndWriteMakeNoHeapCalls) {
#ifdef FOVEA_SANITIZED
  GTEST_SKIP() << "a sanitizer replaces malloc";
#endif
  ASSERT_TRUE(linux_rt::HeapCounterActive());
  Start();
  const std::uint64_t before = linux_rt::CountedHeapCalls();
  for (int k = 0; k < 200; ++k) {
    robot_.SendState();
    if (k == 100) {
      robot_.SendDatagram({});
      robot_.ShowReflex(franka::Error::kJointReflex);
      robot_.AnswerStatus(move_, 6);
    }
    linux_rt::EnterCountedRegion();
    static_cast<void>(arm_->Read(state_));
    static_cast<void>(Write(0.1));
    linux_rt::LeaveCountedRegion();
  }
  EXPECT_EQ(linux_rt::CountedHeapCalls() - before, 0U);
  EXPECT_GT(arm_->counters().commands, 90U);
  EXPECT_EQ(arm_->phase(), MotionPhase::kFailed);
}

TEST(FrankaArm, WithoutAllowMotionNothingIsCommanded) {
  FakeRobot robot;
  franka::FrankaConfig config = ConfigFor(robot);
  config.allow_motion = false;
  std::jthread other([&] { EXPECT_TRUE(robot.ServeSetUp()); });
  franka::FrankaArm arm(config);
  other.join();
  hal::ArmState state;
  hal::ArmCommand command;
  command.num_joints = 7;
  for (int k = 0; k < 5; ++k) {
    robot.SendState();
    ASSERT_TRUE(arm.Read(state).ok());
    EXPECT_TRUE(arm.Write(command).ok());
  }
  EXPECT_EQ(arm.phase(), MotionPhase::kIdle);
  EXPECT_EQ(arm.counters().motions, 0U);
}

}  // namespace
}  // namespace fovea::test
