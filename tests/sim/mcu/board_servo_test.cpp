// SPDX-License-Identifier: Apache-2.0
// The host's end of a board's line, with the servo's end in
// this process: effects of a late, jittering or broken line.
#include "sim/mcu/board_servo.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <memory>

#include "firmware/host/recording/log/record_hash.hpp"
#include "tests/core/task/task_on_ideal_arm.hpp"
#include "tests/sim/mcu/server_line.hpp"

namespace fovea::sim {
namespace {

class BoardServoTest : public task::ServoTaskTest {
 protected:
  void Connect(const BoardConfig& config, std::uint64_t seed = 1) {
    auto line = std::make_unique<test::ServerLine>(config_.arm);
    line_ = line.get();
    servo_ = std::make_unique<BoardServo>(std::move(line), config, seed, config_, model::Load{});
  }
  static BoardConfig ByTimer(const LinkFaults& line = {}, double from_s = 0.0) {
    BoardConfig config;
    config.by_timer = true;
    config.line = line;
    config.line_from_s = from_s;
    return config;
  }

  // Like ServoTaskTest::Tick, with the servo on the board.
  const hal::TickRecord& BoardTick(std::int32_t missed_ticks = 0) {
    task::ServoInputs inputs;
    inputs.missed_ticks = missed_ticks;
    inputs.arm = arm_->State();
    if (ticks_ >= task::kLatencyMs && (ticks_ - task::kLatencyMs) % task::kFrameMs == 0) {
      inputs.has_feature = true;
      inputs.feature = pending_.at(static_cast<std::size_t>(ticks_ - task::kLatencyMs));
    }
    pending_.push_back(Measure());
    servo_->Step(inputs, outputs_);
    arm_->Apply(outputs_.command());
    arm_->Step();
    ++ticks_;
    return outputs_.record;
  }
  std::string BoardRun(int ticks) {
    log::RecordHash hash;
    for (int k = 0; k < ticks; ++k) {
      hash.Add(BoardTick());
    }
    return hash.Finish();
  }
  void ExpectBrakes() const {
    EXPECT_TRUE(outputs_.record.command.engage_brakes);
    for (const double torque : outputs_.record.command.tau_cmd) {
      EXPECT_EQ(torque, 0.0);
    }
  }

  test::ServerLine* line_ = nullptr;
  std::unique_ptr<BoardServo> servo_;
};

TEST_F(BoardServoTest, PerfectLineMatchesTheTaskBitExactAtBothPaces) {
  log::RecordHash here;
  for (int k = 0; k < 2500; ++k) {
    here.Add(Tick());
  }
  const std::string expected = here.Finish();
  for (const bool by_timer : {false, true}) {
    SetUp();
    ticks_ = 0;
    pending_.clear();
    BoardConfig config;
    config.by_timer = by_timer;
    Connect(config);
    EXPECT_EQ(BoardRun(2500), expected) << by_timer;
    EXPECT_EQ(outputs_.record.mode, hal::Mode::kTrack);
    EXPECT_EQ(servo_->Summarise().line, link::LineCounters{});
    EXPECT_EQ(servo_->Summarise().ticks_without_torque, 0U);
  }
}

constexpr LinkFaults kJitter{.loss = 0.01, .delay_ms = 0.2, .jitter_ms = 2.5};
constexpr double kBootedAt = 0.3;  // Boot needs valid states in a row

TEST_F(BoardServoTest, ConvergesThroughJitterAndLoss) {
  Connect(ByTimer(kJitter, kBootedAt));
  BoardRun(8000);
  const BoardSummary summary = servo_->Summarise();
  std::cout << summary.line.silent_ticks << " of 8000 ticks without a state, " << summary.ticks_without_torque
            << " without a torque, " << 1e3 * Error() << " mm off\n";
  EXPECT_EQ(servo_->failure(), "");
  EXPECT_EQ(outputs_.record.fault, hal::Fault::kNone) << hal::Name(outputs_.record.fault);
  EXPECT_EQ(outputs_.record.mode, hal::Mode::kTrack);
  EXPECT_GT(summary.line.silent_ticks, 500U);
  EXPECT_GT(summary.line.late_frames, 0U);
  EXPECT_GT(summary.ticks_without_torque, 500U);
  EXPECT_LT(Error(), 1e-3);
}

TEST_F(BoardServoTest, RunRepeatsForTheSameSeedOnly) {
  std::vector<std::string> hashes;
  for (const std::uint64_t seed : {5U, 5U, 6U}) {
    SetUp();
    ticks_ = 0;
    pending_.clear();
    Connect(ByTimer(kJitter, kBootedAt), seed);
    hashes.push_back(BoardRun(1500));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_NE(hashes[0], hashes[2]);
}

TEST_F(BoardServoTest, TooMuchJitterRaisesArmLostAndStops) {
  Connect(ByTimer({.delay_ms = 0.2, .jitter_ms = 80.0}, 1.2));
  BoardRun(1200);
  ASSERT_EQ(outputs_.record.mode, hal::Mode::kTrack);
  hal::Fault fault = hal::Fault::kNone;
  int ticks = 0;
  for (; ticks < 4000 && !outputs_.record.command.engage_brakes; ++ticks) {
    BoardTick();
    fault = fault == hal::Fault::kNone ? outputs_.record.fault : fault;
  }
  std::cout << "brakes after " << ticks << " ms: " << hal::Name(fault) << ' ' << servo_->Summarise().stopped
            << '\n';
  EXPECT_EQ(fault, hal::Fault::kArmLost);
  for (int k = 0; k < 200; ++k) {
    BoardTick();
  }
  ExpectBrakes();
  EXPECT_LT(arm_->dq().norm(), 1e-2);
}

TEST_F(BoardServoTest, LineWithoutTorquesClosesTheBrakes) {
  Connect(ByTimer({.loss = 1.0}, 1.2));
  BoardRun(1200);
  ASSERT_EQ(outputs_.record.mode, hal::Mode::kTrack);
  int held = 0;
  while (!BoardTick().command.engage_brakes) {
    ++held;
  }
  EXPECT_EQ(held, config_.safety.arm_lost_ticks - 1);
  EXPECT_EQ(servo_->Summarise().stopped, "no torque came from the servo's board for 20 ms");
  BoardTick();
  ExpectBrakes();
}

TEST_F(BoardServoTest, TooLongTickCountsAsMissed) {
  Connect(ByTimer());
  BoardRun(1200);
  ASSERT_EQ(outputs_.record.mode, hal::Mode::kTrack);
  line_->board.periods_in_tick = 3;
  BoardTick();
  EXPECT_EQ(servo_->OverrunNs(), 2 * hal::kTickPeriodNs);
  line_->board.periods_in_tick = 1;  // ends as the next one starts: late, but not missed
  EXPECT_EQ(BoardTick(2).missed_ticks, 2);
  EXPECT_EQ(servo_->OverrunNs(), 0);
  EXPECT_EQ(BoardTick().missed_ticks, 0);
  EXPECT_EQ(servo_->Summarise().line.missed_ticks, 2U);
  EXPECT_EQ(outputs_.record.fault, hal::Fault::kNone);

  line_->board.periods_in_tick = static_cast<std::uint32_t>(config_.safety.missed_ticks) + 1;
  BoardTick();
  line_->board.periods_in_tick = 0;
  BoardTick(config_.safety.missed_ticks);
  EXPECT_EQ(outputs_.record.fault, hal::Fault::kDeadlineMissed);
  EXPECT_EQ(outputs_.record.mode, hal::Mode::kFault);
}

TEST_F(BoardServoTest, VanishedBoardClosesTheBrakes) {
  for (const bool by_timer : {false, true}) {
    SetUp();
    ticks_ = 0;
    pending_.clear();
    BoardConfig config;
    config.by_timer = by_timer;
    Connect(config);
    BoardRun(1000);
    line_->is_gone = true;
    BoardTick();
    ExpectBrakes();
    EXPECT_EQ(outputs_.record.mode, hal::Mode::kFault);
    EXPECT_EQ(servo_->failure(), "the servo's board is gone");
  }
}

TEST_F(BoardServoTest, ArmOtherThanTheBoardsIsRefusedByName) {
  config_.arm.joints[2].coulomb += 0.1;
  auto line = std::make_unique<test::ServerLine>(test::Panda().model);
  try {
    const BoardServo servo(std::move(line), {}, 1, config_, model::Load{});
    FAIL() << "another arm than the board's was accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("its image holds the shipped panda"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace fovea::sim
