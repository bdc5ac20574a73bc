// SPDX-License-Identifier: Apache-2.0
// The servo behind a serial line, without the processor: the right ticks and the right refusals.
#include "firmware/core/link/servo_server.hpp"

#include <gtest/gtest.h>

#include <array>

#include "firmware/host/recording/log/record_hash.hpp"
#include "tests/core/link/servo_server_fixture.hpp"

namespace fovea::link {
namespace {

TEST_F(ServoServerTest, AnswersAHelloFrame) {
  server_.SayHello();
  EXPECT_TRUE(Answered());
  EXPECT_EQ(reader_.frame().kind, FrameKind::kHello);
  Give({FrameKind::kHello, 0, {}});
  EXPECT_TRUE(Answered());
}

// Each tick gives the same bits as a task that is called directly.
TEST_F(ServoServerTest, LockstepGivesTheSameBitsAsTheTask) {
  ASSERT_EQ(Configure(Pacing::kLockstep).code, hal::StatusCode::kOk);
  log::RecordHash here;
  log::RecordHash there;
  for (std::uint32_t k = 1; k <= 3000; ++k) {
    task::ServoInputs given;
    here.Add(Tick([&](task::ServoInputs& inputs) {
      if (k % 700 == 0) {
        inputs.tuning = {0, k == 1400 ? 50.0 : 1e-3 * k};  // one is refused
      }
      given = inputs;
    }));
    EXPECT_EQ(outputs_.record.tuning.result != hal::TuningResult::kNone, k % 700 == 0);
    Give({FrameKind::kInputs, k, Encode(given, payload_)});
    if (k % 7 == 0) {  // the frame arrives twice: two answers, one step
      Give({FrameKind::kInputs, k, Encode(given, payload_)});
    }
    Outputs outputs = Taken();
    outputs.record.arm = given.arm;
    outputs.record.has_feature = given.has_feature;
    outputs.record.feature = given.feature;
    there.Add(outputs.record);
    EXPECT_EQ(outputs.stack_bytes, 1234U);
    EXPECT_GT(outputs.tick_counts, 0U);
  }
  EXPECT_EQ(outputs_.record.mode, hal::Mode::kTrack);
  EXPECT_EQ(there.Finish(), here.Finish());
}

// `link_counts` is the line's time for a tick. It must not include frames before the configuration.
TEST_F(ServoServerTest, ReconfigurationResetsTheLinkCounts) {
  for (int run = 0; run < 2; ++run) {
    for (int k = 0; k < 5; ++k) {
      Give({FrameKind::kHello, 0, {}});
    }
    ASSERT_EQ(Configure(Pacing::kLockstep).code, hal::StatusCode::kOk);
    std::array<std::uint32_t, 2> link_counts{};
    for (std::uint32_t k = 0; k < 2; ++k) {
      Give({FrameKind::kInputs, k, Encode(task::ServoInputs{}, payload_)});
      link_counts.at(k) = Taken().link_counts;
    }
    EXPECT_GT(link_counts[0], 0U);
    EXPECT_LE(link_counts[0], link_counts[1]) << "run " << run;
  }
}

TEST_F(ServoServerTest, ConfiguredLoadReachesTheServo) {
  model::Load load;
  load.mass = 0.7;
  load.p_ECom = {0.0, 0.02, 0.05};
  const auto with_load = [&](Configuration& c) {
    c.load = load;
    model::ArmModel arm = config_.arm;
    model::Attach(load, arm);
    c.arm_crc = ArmCrc(arm);
  };
  EXPECT_EQ(Configure(Pacing::kLockstep, with_load).code, hal::StatusCode::kOk);
}

TEST_F(ServoServerTest, RefusesABadConfigurationAndNamesTheKey) {
  Answer answer = Configure(Pacing::kLockstep, [](Configuration& c) { c.arm_crc ^= 1U; });
  EXPECT_EQ(answer.code, hal::StatusCode::kInvalidArgument);
  EXPECT_STREQ(answer.where.data(), "arm");
  answer = Configure(Pacing::kLockstep, [](Configuration& c) { c.servo.law.lambda = -1.0; });
  EXPECT_EQ(answer.code, hal::StatusCode::kOutOfRange);
  EXPECT_NE(std::string(answer.where.data()).find("lambda"), std::string::npos) << answer.where.data();
  // The server does nothing before it is configured.
  Give({FrameKind::kInputs, 1, Encode(task::ServoInputs{}, payload_)});
  EXPECT_FALSE(Answered());
}

TEST_F(ServoServerTest, ProvocationNeedsPermission) {
  Give({FrameKind::kProvoke, 1, Encode(Provocation::kUsageFault, payload_)});
  Configure(Pacing::kLockstep);
  Give({FrameKind::kProvoke, 1, Encode(Provocation::kUsageFault, payload_)});
  EXPECT_EQ(board_.provoked, 0);
  Configure(Pacing::kLockstep, [](Configuration& c) { c.may_provoke = true; });
  Give({FrameKind::kProvoke, 1, Encode(Provocation::kUsageFault, payload_)});
  EXPECT_EQ(board_.provoked, 1);
}
// The timer stands from a tick's end until the host sends Go. A repeated Go is harmless.
TEST_F(ServoServerTest, GatedTimerStandsUntilTheHostSaysGo) {
  ASSERT_EQ(Configure(Pacing::kGated).code, hal::StatusCode::kOk);
  EXPECT_FALSE(board_.timer_runs);
  task::ServoInputs inputs;
  inputs.arm = arm_->State();
  Give({FrameKind::kInputs, 1, Encode(inputs, payload_)});
  Pass(1);
  EXPECT_FALSE(Answered());
  Give({FrameKind::kGo, 1, {}});
  Give({FrameKind::kGo, 1, {}});
  EXPECT_TRUE(board_.timer_runs);
  Pass(0);
  const Outputs outputs = Taken();
  EXPECT_EQ(outputs.line.silent_ticks, 0U);
  EXPECT_FALSE(board_.timer_runs);
  Give({FrameKind::kGo, 1, {}});  // the host did not receive the answer
  EXPECT_FALSE(board_.timer_runs);
  EXPECT_EQ(Taken().record.tick, outputs.record.tick);
  Give({FrameKind::kGo, 2, {}});
  Pass(1);
  EXPECT_EQ(Taken().line.silent_ticks, 1U);
}

}  // namespace
}  // namespace fovea::link
