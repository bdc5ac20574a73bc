// The loop keeps its grid, counts what it misses, and hands everything on.
#include "fovea/servo/servo_loop.hpp"

#include <gtest/gtest.h>

#include "support/fake_drivers.hpp"
#include "support/panda.hpp"

namespace fovea::servo {
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

TEST_F(ServoLoopTest, MissesAreCountedAndToldAndTheGridStays) {
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

// The last deadline is the end: what passes after it is no miss.
TEST_F(ServoLoopTest, NothingIsMissedBeyondTheEnd) {
  clock_.late_ns = {0, 0, 0, 0, 0, 0, 0, 0, 1'500'000, 3'200'000};
  EXPECT_TRUE(loop_.Run(10 * hal::kNsPerMs).ok());
  EXPECT_EQ(loop_.counters().ticks + loop_.counters().missed_ticks, 10U);
}

// An arm with a clock of its own: the loop ticks when it answers, however its period compares with ours.
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

TEST_F(PacedLoopTest, AStallIsSeenInTheStampsOfTheArm) {
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

TEST_F(PacedLoopTest, ASilentArmIsTickedForAndAnArmThatIsGoneDoesNotSpinTheLoop) {
  EXPECT_TRUE(paced_.Run(10 * hal::kNsPerMs).ok());
  pacing_.read_status = hal::Status(hal::StatusCode::kTimeout);
  EXPECT_TRUE(paced_.Run(15 * hal::kNsPerMs).ok());
  EXPECT_EQ(paced_.counters().arm_read_errors, 5U);
  pacing_.read_status = hal::Status(hal::StatusCode::kDisconnected);
  pacing_.before_read = {};  // it answers at once
  EXPECT_TRUE(paced_.Run(50 * hal::kNsPerMs).ok());
  EXPECT_EQ(paced_.counters().arm_read_errors, 40U);
  EXPECT_EQ(recorder_.records.back().mode, hal::Mode::kFault);
}

TEST_F(ServoLoopTest, HandsTheNewestFeatureOnOnce) {
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

}  // namespace
}  // namespace fovea::servo
