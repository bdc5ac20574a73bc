// SPDX-License-Identifier: Apache-2.0
// The loop keeps its time grid, counts missed ticks, and passes on features, requests and motions.
#include "firmware/core/task/servo_loop.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <vector>

#include "tests/support/fake_drivers.hpp"
#include "tests/support/panda.hpp"

namespace fovea::task {
namespace {

class ServoLoopTest : public testing::Test {
 protected:
  ServoLoopTest() {
    EXPECT_TRUE(task_.Init(test::PandaConfig()).ok());
    arm_.state.q = test::Panda().model.q_ready;
  }
  ServoTask task_;
  test::FakeArm arm_{7};
  test::FakeClock clock_;
  hal::FeatureMailbox mailbox_;
  test::ListRecorder recorder_;
  test::NoProbe probe_;
  ServoLoop loop_{task_, arm_, clock_, mailbox_, recorder_, probe_};
};

TEST_F(ServoLoopTest, TicksOnceAMillisecondOnAFixedGrid) {
  EXPECT_TRUE(loop_.Run(100 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().ticks, 100U);
  EXPECT_EQ(loop_.counters().overruns, 0U);
  EXPECT_EQ(arm_.written.size(), 100U);
  EXPECT_EQ(recorder_.records.size(), 100U);
  for (std::size_t i = 0; i < clock_.deadlines_ns.size(); ++i) {
    EXPECT_EQ(clock_.deadlines_ns[i], static_cast<std::int64_t>(i + 1) * hal::kNsPerMs);
  }
}

TEST_F(ServoLoopTest, LatenessWithinAPeriodIsNoMissAndDoesNotShiftTheGrid) {
  clock_.late_ns = {400'000, 0, 999'999, 0};
  EXPECT_TRUE(loop_.Run(10 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().overruns, 0U);
  EXPECT_EQ(clock_.deadlines_ns.back(), 10 * hal::kNsPerMs);
}

TEST_F(ServoLoopTest, MissedTicksAreCountedAndReportedAndTheGridStays) {
  clock_.late_ns = {0, 3'200'000, 0, 1'000'000};
  EXPECT_TRUE(loop_.Run(12 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().overruns, 2U);
  EXPECT_EQ(loop_.counters().missed_ticks, 4U);
  EXPECT_EQ(loop_.counters().ticks, 8U);
  EXPECT_EQ(recorder_.records[2].missed_ticks, 3);
  EXPECT_EQ(recorder_.records[3].missed_ticks, 0);
  EXPECT_EQ(recorder_.records[4].missed_ticks, 1);
  for (const std::int64_t deadline : clock_.deadlines_ns) {
    EXPECT_EQ(deadline % hal::kNsPerMs, 0);
  }
}

// Time after the last deadline of a run is no missed tick.
TEST_F(ServoLoopTest, TimePastTheLastDeadlineIsNoMiss) {
  clock_.late_ns = {0, 0, 0, 0, 0, 0, 0, 0, 1'500'000, 3'200'000};
  EXPECT_TRUE(loop_.Run(10 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().ticks + loop_.counters().missed_ticks, 10U);
}

// An arm with its own clock: the loop ticks when the arm answers, whatever the arm's period.
class PacedLoopTest : public ServoLoopTest {
 protected:
  PacedLoopTest() {
    pacing_.state.q = test::Panda().model.q_ready;
    pacing_.before_read = [this] {
      clock_.now_ns += period_ns_;
      if (pacing_.read_status.ok()) {
        pacing_.state.stamp_ns += period_ns_;
        ++pacing_.state.sequence;
      }
    };
  }
  std::int64_t period_ns_ = hal::kNsPerMs;
  test::FakeArm pacing_{7, /*paces_loop=*/true};
  ServoLoop paced_{task_, pacing_, clock_, mailbox_, recorder_, probe_};
};

TEST_F(PacedLoopTest, TicksAtTheArmsPaceAndWaitsForNothingElse) {
  for (const std::int64_t period_ns : {999'000, 1'000'000, 1'000'050}) {
    period_ns_ = period_ns;
    EXPECT_TRUE(paced_.Run(clock_.now_ns + 50'000 * period_ns).ok());
    EXPECT_EQ(paced_.counters().missed_ticks, 0U) << period_ns;
  }
  EXPECT_TRUE(clock_.deadlines_ns.empty());
  EXPECT_EQ(paced_.counters().ticks, 150'000U);
}

TEST_F(PacedLoopTest, StallIsCountedFromTheArmsStamps) {
  period_ns_ = 999'000;
  int reads = 0;
  const auto usual = pacing_.before_read;
  pacing_.before_read = [&] {
    if (++reads == 30'000) {
      clock_.now_ns += 15 * period_ns_;
      pacing_.state.stamp_ns += 15 * period_ns_;
    }
    usual();
  };
  EXPECT_TRUE(paced_.Run(40'000 * period_ns_).ok());
  EXPECT_EQ(paced_.counters().overruns, 1U);
  EXPECT_EQ(paced_.counters().missed_ticks, 15U);
  EXPECT_EQ(recorder_.records[29'999].missed_ticks, 15);
}

TEST_F(PacedLoopTest, SilentOrDisconnectedArmStillTicksAtTheLoopRate) {
  EXPECT_TRUE(paced_.Run(10 * hal::kNsPerMs).ok());
  pacing_.read_status = hal::Status(hal::StatusCode::kTimeout);
  EXPECT_TRUE(paced_.Run(15 * hal::kNsPerMs).ok());
  EXPECT_EQ(paced_.counters().arm_read_errors, 5U);
  pacing_.read_status = hal::Status(hal::StatusCode::kDisconnected);
  pacing_.before_read = {};  // the arm answers at once
  EXPECT_TRUE(paced_.Run(50 * hal::kNsPerMs).ok());
  EXPECT_EQ(paced_.counters().arm_read_errors, 40U);
  EXPECT_EQ(recorder_.records.back().mode, hal::Mode::kFault);
}

// The arm is lost after arm_lost_ticks milliseconds of silence, however long each failed read takes.
TEST_F(PacedLoopTest, SilentArmIsLostByTimeAndNotByReadCount) {
  const int limit = test::PandaConfig().safety.arm_lost_ticks;
  for (const std::int64_t timeout_ms : {1, 2, 5, 7, 20, 40}) {
    test::FakeArm arm(7, /*paces_loop=*/true);
    arm.state.q = test::Panda().model.q_ready;
    ServoTask task;
    ASSERT_TRUE(task.Init(test::PandaConfig()).ok());
    test::FakeClock clock;
    test::ListRecorder recorder;
    ServoLoop loop(task, arm, clock, mailbox_, recorder, probe_);
    arm.before_read = [&] {
      clock.now_ns += (arm.read_status.ok() ? 1 : timeout_ms) * hal::kNsPerMs;
      arm.state.stamp_ns = clock.now_ns;
    };
    EXPECT_TRUE(loop.Run(100 * hal::kNsPerMs).ok());
    ASSERT_EQ(recorder.records.back().mode, hal::Mode::kHold);
    arm.read_status = hal::Status(hal::StatusCode::kTimeout);
    while (recorder.records.back().fault == hal::Fault::kNone && clock.now_ns < 2 * hal::kNsPerSecond) {
      EXPECT_TRUE(loop.Run(clock.now_ns + 1).ok());
    }
    const std::int64_t silent_ms = clock.now_ns / hal::kNsPerMs - 100;
    std::printf("reads of %d ms: %s after %d ms of silence\n", static_cast<int>(timeout_ms),
                hal::Name(recorder.records.back().fault), static_cast<int>(silent_ms));
    EXPECT_EQ(recorder.records.back().fault, hal::Fault::kArmLost) << timeout_ms;
    EXPECT_GE(silent_ms, limit) << timeout_ms;
    EXPECT_LT(silent_ms, limit + timeout_ms) << timeout_ms;
  }
}

// Ticks that were counted as missed in the silence are not counted again from the arm's next stamp.
TEST_F(PacedLoopTest, SilenceIsNotCountedAgainFromStamps) {
  int reads = 0;
  pacing_.before_read = [&] {
    ++reads;
    const bool silent = reads == 51 || reads == 52;
    const std::int64_t passed_ns = (silent ? 6 : 1) * hal::kNsPerMs;
    clock_.now_ns += passed_ns;
    pacing_.state.stamp_ns = clock_.now_ns;
    pacing_.read_status = hal::Status(silent ? hal::StatusCode::kTimeout : hal::StatusCode::kOk);
  };
  EXPECT_TRUE(paced_.Run(100 * hal::kNsPerMs).ok());
  EXPECT_EQ(recorder_.records[50].missed_ticks, 5);
  EXPECT_EQ(recorder_.records[51].missed_ticks, 5);
  EXPECT_EQ(recorder_.records[52].missed_ticks, 0);
  EXPECT_EQ(paced_.counters().ticks + paced_.counters().missed_ticks, 100U);
  EXPECT_EQ(recorder_.records.back().fault, hal::Fault::kNone);
}

TEST_F(ServoLoopTest, PassesTheNewestFeatureOnExactlyOnce) {
  hal::FeatureMeasurement m;
  m.sequence = 9;
  mailbox_.Put(m);
  EXPECT_TRUE(loop_.Run(3 * hal::kNsPerMs).ok());
  EXPECT_TRUE(recorder_.records[0].has_feature);
  EXPECT_EQ(recorder_.records[0].feature.sequence, 9U);
  EXPECT_FALSE(recorder_.records[1].has_feature);
}

TEST_F(ServoLoopTest, CountsReadErrorsAndStopsWhenTold) {
  arm_.read_status = hal::Status(hal::StatusCode::kTimeout);
  EXPECT_TRUE(loop_.Run(5 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().arm_read_errors, 5U);
  loop_.Stop();
  EXPECT_TRUE(loop_.Run(50 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().ticks, 5U);
}

TEST_F(ServoLoopTest, CountsCommandsThatTheArmRefuses) {
  arm_.write_status = hal::Status(hal::StatusCode::kDeviceFault);
  EXPECT_TRUE(loop_.Run(3 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().arm_write_errors, 3U);
  EXPECT_EQ(loop_.counters().arm_read_errors, 0U);
}

// Keeps the requests and motions that it receives.
class ListeningStep final : public ServoStep {
 public:
  void Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept override {
    outputs.record = {};
    outputs.record.mode = mode;
    outputs.record.dq_cmd[0] = speed;
    outputs.record.command.num_joints = inputs.arm.num_joints;
    outputs.record.command.engage_brakes = brakes;
    requests.push_back(inputs.request);
    motions.push_back(inputs.motion.kind);
    tunings.push_back(inputs.tuning);
    if (before_next) {
      before_next(static_cast<int>(requests.size()));
    }
  }
  std::function<void(int)> before_next;  // with the number of ticks so far
  std::vector<Request> requests;
  std::vector<moves::MotionKind> motions;
  std::vector<config::Tuning> tunings;
  hal::Mode mode = hal::Mode::kHold;
  double speed = 0.0;
  bool brakes = false;
};

class GivenMotion final : public moves::MotionSource {
 public:
  moves::MotionCommand At(std::int64_t /*now_ns*/) noexcept override { return command; }
  moves::MotionCommand command;
};

// The lease: a permission to move that runs out.
class LeaseTest : public testing::Test {
 protected:
  void RunMs(int ms) { EXPECT_TRUE(loop_.Run(clock_.now_ns + ms * hal::kNsPerMs).ok()); }
  ListeningStep step_;
  test::FakeArm arm_{7};
  test::FakeClock clock_;
  hal::FeatureMailbox mailbox_;
  test::ListRecorder recorder_;
  test::NoProbe probe_;
  GivenMotion source_;
  ServoLoop loop_{step_, arm_, clock_, mailbox_, recorder_, probe_};
};

TEST_F(LeaseTest, WithoutALeaseNoRequestExpires) {
  loop_.Ask(Request::kTrack);
  RunMs(100);
  EXPECT_EQ(step_.requests[0], Request::kTrack);
  EXPECT_EQ(step_.requests[99], Request::kNone);
  EXPECT_EQ(loop_.counters().lease_ends, 0U);
}

// A key moves nothing by itself, so it needs no permission.
TEST_F(LeaseTest, OneKeyChangesPerTick) {
  loop_.GiveLeave(0);
  EXPECT_TRUE(loop_.Ask(config::Tuning{4, 0.5}));
  EXPECT_TRUE(loop_.Ask(config::Tuning{0, 3.0}));
  EXPECT_TRUE(loop_.Ask(config::Tuning{0, 4.0}));
  EXPECT_FALSE(loop_.Ask(config::Tuning{99, 4.0}));
  RunMs(3);
  EXPECT_EQ(step_.tunings[0].key, 0);
  EXPECT_EQ(step_.tunings[0].value, 4.0);
  EXPECT_EQ(step_.tunings[1].key, 4);
  EXPECT_EQ(step_.tunings[1].value, 0.5);
  EXPECT_FALSE(step_.tunings[2].IsAsked());
}

TEST_F(LeaseTest, ExpiredLeaseHoldsEveryTickAndDropsRequests) {
  loop_.GiveLeave(50 * hal::kNsPerMs);
  loop_.Ask(Request::kTrack);
  step_.before_next = [this](int ticks) {
    if (ticks == 70) {
      loop_.Ask(Request::kTrack);
    }
  };
  RunMs(100);
  EXPECT_EQ(step_.requests[0], Request::kTrack);
  for (std::size_t k = 1; k < 100; ++k) {
    EXPECT_EQ(step_.requests[k], k < 50 ? Request::kNone : Request::kHold) << k;
  }
  EXPECT_EQ(loop_.lease_ends(), 1U) << "reported once";

  loop_.GiveLeave(150 * hal::kNsPerMs);
  RunMs(20);
  EXPECT_EQ(step_.requests.back(), Request::kNone) << "nothing begins again by itself";
  loop_.Ask(Request::kTrack);
  RunMs(1);
  EXPECT_EQ(step_.requests.back(), Request::kTrack);
  RunMs(79);
  EXPECT_EQ(step_.requests.back(), Request::kHold);
  EXPECT_EQ(loop_.counters().lease_ends, 2U);
}

TEST_F(LeaseTest, ExpiredLeaseEndsACommandedMotionForGood) {
  loop_.UseMotion(source_);
  loop_.GiveLeave(50 * hal::kNsPerMs);
  source_.command.kind = moves::MotionKind::kHome;
  RunMs(60);
  EXPECT_EQ(step_.motions[49], moves::MotionKind::kHome);
  EXPECT_EQ(step_.motions[50], moves::MotionKind::kNone);
  loop_.GiveLeave(1000 * hal::kNsPerMs);
  RunMs(20);
  EXPECT_EQ(step_.motions.back(), moves::MotionKind::kNone) << "as long as the command is the same";
  source_.command.kind = moves::MotionKind::kNone;
  RunMs(1);
  source_.command.kind = moves::MotionKind::kHome;
  RunMs(1);
  EXPECT_EQ(step_.motions.back(), moves::MotionKind::kHome);
}

TEST_F(LeaseTest, FinishHoldsUntilTheArmRests) {
  step_.mode = hal::Mode::kTrack;
  step_.speed = 0.5;
  step_.before_next = [this](int ticks) {
    if (ticks == 10) {
      loop_.Ask(Request::kTrack);
      loop_.Finish();
    } else if (ticks == 30) {
      step_.speed = 0.0;
    }
  };
  RunMs(1000);
  EXPECT_EQ(loop_.finish_tick(), 10U);
  EXPECT_EQ(step_.requests[10], Request::kHold);
  EXPECT_EQ(step_.requests.size(), 31U);
}

TEST_F(LeaseTest, FinishEndsTheRunEvenWithoutRestOrStates) {
  step_.speed = 0.5;
  loop_.Finish();
  RunMs(5000);
  EXPECT_EQ(step_.requests.size(), 2000U);
  ServoLoop silent(step_, arm_, clock_, mailbox_, recorder_, probe_);
  arm_.read_status = hal::Status(hal::StatusCode::kTimeout);
  silent.Finish();
  EXPECT_TRUE(silent.Run(clock_.now_ns + hal::kNsPerSecond).ok());
  EXPECT_EQ(silent.counters().ticks, 5U);
  ServoLoop braked(step_, arm_, clock_, mailbox_, recorder_, probe_);
  step_.brakes = true;
  braked.Finish();
  EXPECT_TRUE(braked.Run(clock_.now_ns + hal::kNsPerSecond).ok());
  EXPECT_EQ(braked.counters().ticks, 1U);
}

}  // namespace
}  // namespace fovea::task
