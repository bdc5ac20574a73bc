// SPDX-License-Identifier: Apache-2.0
// The servo behind a serial line, paced by its own timer: one tick in each period, whatever the line does to
// frames.
#include "firmware/core/link/servo_server.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "tests/core/link/servo_server_fixture.hpp"

namespace fovea::link {
namespace {

// Paced by its own timer: one tick in each period, whether the host sends or not.
class ServoServerByTimerTest : public ServoServerTest {
 protected:
  void SetUp() override {
    ServoServerTest::SetUp();
    ASSERT_EQ(Configure(Pacing::kTimer).code, hal::StatusCode::kOk);
  }

  // Sends the arm's state through `line`; the server ticks, and the arm applies the command.
  Outputs TickThrough(const std::function<void(std::span<const std::uint8_t>)>& line) {
    task::ServoInputs inputs;
    inputs.arm = arm_->State();
    if (ticks_ % kFrameMs == 0) {
      inputs.has_feature = true;
      inputs.feature = Measure();
    }
    ++ticks_;
    line(writer_.Encode({FrameKind::kInputs, static_cast<std::uint32_t>(ticks_), Encode(inputs, payload_)}));
    Pass(1);
    const Outputs outputs = Taken();
    arm_->Apply(outputs.record.command);
    arm_->Step();
    return outputs;
  }
  static constexpr int kFrameMs = 33;
};

TEST_F(ServoServerByTimerTest, ConvergesOverALossyDamagingLine) {
  std::mt19937 engine(5);
  Outputs outputs;
  for (int k = 0; k < 8000; ++k) {
    outputs = TickThrough([&](std::span<const std::uint8_t> bytes) {
      if (engine() % 100 < 3) {
        return;  // lost
      }
      std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
      if (engine() % 100 < 2) {
        copy[engine() % copy.size()] ^= 0x10;
      }
      server_.Receive(copy);
    });
    ASSERT_EQ(outputs.record.fault, hal::Fault::kNone) << hal::Name(outputs.record.fault) << " at " << k;
  }
  std::cout << outputs.line.silent_ticks << " ticks without a state, " << outputs.line.damaged_frames
            << " frames damaged, " << 1e3 * Error() << " mm from the goal\n";
  EXPECT_EQ(outputs.record.mode, hal::Mode::kTrack);
  EXPECT_GT(outputs.line.silent_ticks, 200U);
  EXPECT_GT(outputs.line.damaged_frames, 50U);
  EXPECT_LT(Error(), 1e-3);
}

TEST_F(ServoServerByTimerTest, SilentLineRaisesArmLost) {
  Outputs outputs;
  for (int k = 0; k < 1500; ++k) {
    outputs = TickThrough([&](std::span<const std::uint8_t> bytes) { server_.Receive(bytes); });
  }
  ASSERT_EQ(outputs.record.mode, hal::Mode::kTrack);
  int until_fault = 0;
  for (int k = 0; k < 3000; ++k) {
    outputs = TickThrough([](std::span<const std::uint8_t> /*bytes*/) {});
    until_fault += outputs.record.fault == hal::Fault::kNone ? 1 : 0;
  }
  EXPECT_EQ(outputs.record.mode, hal::Mode::kFault);
  EXPECT_EQ(outputs.record.fault, hal::Fault::kArmLost);
  EXPECT_LE(until_fault, config_.safety.arm_lost_ticks);
  EXPECT_TRUE(outputs.record.command.engage_brakes);
  EXPECT_LT(arm_->dq().norm(), 1e-2);
}

TEST_F(ServoServerByTimerTest, StormOfBadFramesRaisesArmLost) {
  Outputs outputs;
  for (int k = 0; k < 1500; ++k) {
    outputs = TickThrough([&](std::span<const std::uint8_t> bytes) { server_.Receive(bytes); });
  }
  for (int k = 0; k < 3000; ++k) {
    outputs = TickThrough([&](std::span<const std::uint8_t> bytes) {
      std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
      copy[copy.size() / 2] ^= 0x55;
      server_.Receive(copy);
    });
  }
  EXPECT_EQ(outputs.record.fault, hal::Fault::kArmLost);
  EXPECT_TRUE(outputs.record.command.engage_brakes);
  EXPECT_GE(outputs.line.damaged_frames, 2900U);
}

// Two frames in one period: the tick uses the newer state, and the feature of the older frame.
TEST_F(ServoServerByTimerTest, OvertakenFrameStillDeliversItsFeature) {
  task::ServoInputs first;
  first.arm = arm_->State();
  first.has_feature = true;
  first.feature = Measure();
  task::ServoInputs second;
  second.arm = arm_->State();
  second.arm.sequence += 1;
  Give({FrameKind::kInputs, 1, Encode(first, payload_)});
  Give({FrameKind::kInputs, 2, Encode(second, payload_)});
  Give({FrameKind::kInputs, 1, Encode(first, payload_)});  // late: changes nothing
  Pass(1);
  const Outputs outputs = Taken();
  EXPECT_EQ(reader_.frame().sequence, 2U);
  EXPECT_EQ(outputs.record.command.state_sequence, second.arm.sequence);
  EXPECT_NE(outputs.record.intake, hal::Intake::kNone) << "the feature of the overtaken frame";
}

// A key of the older frame changes, too; a tick without a frame does not change it again.
TEST_F(ServoServerByTimerTest, OvertakenFrameStillChangesItsKey) {
  const auto send = [&](std::uint32_t sequence, const config::Tuning& tuning) {
    task::ServoInputs inputs;
    inputs.arm = arm_->State();
    inputs.tuning = tuning;
    Give({FrameKind::kInputs, sequence, Encode(inputs, payload_)});
  };
  send(1, {0, 3.0});
  send(2, {});
  Pass(1);
  const hal::TuningNote note = Taken().record.tuning;
  EXPECT_EQ(note.result, hal::TuningResult::kTaken);
  EXPECT_EQ(note.asked, 3.0);
  Pass(1);
  EXPECT_EQ(Taken().record.tuning.result, hal::TuningResult::kNone);
  send(3, {0, 4.0});
  send(4, {4, 0.1});
  Pass(1);
  EXPECT_EQ(Taken().record.tuning.key, 4) << "the newer one";
}

// A Hold is not lost if the next frame asks to track before a tick.
TEST_F(ServoServerByTimerTest, HoldOfAnOvertakenFrameComesFirst) {
  Outputs outputs;
  for (int k = 0; k < 1500; ++k) {
    outputs = TickThrough([&](std::span<const std::uint8_t> bytes) { server_.Receive(bytes); });
  }
  ASSERT_EQ(outputs.record.mode, hal::Mode::kTrack);
  std::uint32_t sequence = reader_.frame().sequence;
  const auto send = [&](std::uint32_t number, task::Request request) {
    task::ServoInputs inputs;
    inputs.arm = arm_->State();
    inputs.request = request;
    Give({FrameKind::kInputs, number, Encode(inputs, payload_)});
  };
  send(++sequence, task::Request::kHold);
  send(++sequence, task::Request::kTrack);
  for (const hal::Mode mode : {hal::Mode::kHold, hal::Mode::kTrack}) {
    Pass(1);
    EXPECT_EQ(Taken().record.mode, mode);
  }
  // Of a frame that was overtaken, the Hold still counts, and nothing else.
  send(sequence + 2, task::Request::kNone);
  Pass(1);
  EXPECT_EQ(Taken().record.mode, hal::Mode::kTrack);
  send(sequence + 1, task::Request::kHold);
  Pass(1);
  EXPECT_EQ(Taken().record.mode, hal::Mode::kHold);
  send(sequence + 1, task::Request::kTrack);
  Pass(1);
  EXPECT_EQ(Taken().record.mode, hal::Mode::kHold);
}

// A frame that is older than an arm may be silent is ignored, even if it is the newest.
TEST_F(ServoServerByTimerTest, TooOldStateIsIgnoredAndCounted) {
  const int most = config_.safety.arm_lost_ticks;
  task::ServoInputs inputs;
  inputs.arm = arm_->State();
  std::uint32_t sequence = 0;
  const auto tick = [&](int age_ms) {
    inputs.arm.stamp_ns = (++ticks_ - age_ms) * hal::kTickPeriodNs;
    Give({FrameKind::kInputs, ++sequence, Encode(inputs, payload_)});
    Pass(1);
    return Taken();
  };
  for (int k = 0; k < 100; ++k) {
    tick(5);  // as on a line with constant delay
  }
  EXPECT_EQ(tick(5 + most - 1).line.late_frames, 0U);
  const Outputs outputs = tick(5 + most + 1);  // the clocks may drift
  EXPECT_EQ(outputs.line.late_frames, 1U);
  EXPECT_EQ(outputs.line.silent_ticks, 1U);
}

TEST_F(ServoServerByTimerTest, ReportsLostBytesUnsentFramesAndMissedTicks) {
  board_.lost = {7, 2};
  const Outputs outputs = TickThrough([&](std::span<const std::uint8_t> bytes) { server_.Receive(bytes); });
  EXPECT_EQ(outputs.line.lost_bytes, 7U);
  EXPECT_EQ(outputs.line.unsent_frames, 2U);
  EXPECT_EQ(outputs.line.missed_ticks, 0U);
  Pass(4);
  const Outputs late = Taken();
  EXPECT_EQ(late.line.missed_ticks, 3U);
  EXPECT_EQ(late.record.missed_ticks, 3);
  EXPECT_EQ(late.line.silent_ticks, 1U);
}

}  // namespace
}  // namespace fovea::link
