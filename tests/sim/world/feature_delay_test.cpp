// SPDX-License-Identifier: Apache-2.0
// The modelled latency: no measurement before its time, all in order; lockstep waits and real pace does not.
#include "sim/world/feature_delay.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace fovea::sim {
namespace {

hal::FeatureMeasurement Measurement(std::uint64_t sequence) {
  hal::FeatureMeasurement m;
  m.sequence = sequence;
  m.stamp_ns = static_cast<std::int64_t>(sequence) * 1'000'000;
  return m;
}

class FeatureDelayTest : public ::testing::Test {
 protected:
  // The sequence number that the servo would read now; -1: nothing new.
  std::int64_t Taken() {
    hal::FeatureMeasurement m;
    return mailbox_.Take(m) ? static_cast<std::int64_t>(m.sequence) : -1;
  }
  FeatureDelay delay_;
  hal::FeatureMailbox mailbox_;
};

TEST_F(FeatureDelayTest, MeasurementIsHeldUntilItIsDue) {
  delay_.Expect(1, 40'000'000);
  delay_.Put(Measurement(1));
  EXPECT_TRUE(delay_.HandOver(39'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), -1);
  EXPECT_TRUE(delay_.HandOver(40'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), 1);
  EXPECT_TRUE(delay_.HandOver(41'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), -1);
}

TEST_F(FeatureDelayTest, LockstepWaitsForALateMeasurement) {
  delay_.Expect(1, 40'000'000);
  std::thread vision([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    delay_.Put(Measurement(1));
  });
  EXPECT_TRUE(delay_.HandOver(40'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), 1);
  vision.join();
}

TEST_F(FeatureDelayTest, RealPaceHandsALateMeasurementOverWhenItComes) {
  delay_.Expect(1, 40'000'000);
  EXPECT_TRUE(delay_.HandOver(40'000'000, false, mailbox_));
  EXPECT_EQ(Taken(), -1);
  delay_.Put(Measurement(1));
  EXPECT_TRUE(delay_.HandOver(45'000'000, false, mailbox_));
  EXPECT_EQ(Taken(), 1);
}

// A lost frame never gets a measurement; a later measurement reveals that.
TEST_F(FeatureDelayTest, LostFrameDoesNotBlockLaterOnes) {
  delay_.Expect(1, 40'000'000);
  delay_.Expect(2, 70'000'000);
  delay_.Put(Measurement(2));
  EXPECT_TRUE(delay_.HandOver(70'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), 2);
}

// The awaited frame is lost during the wait, and no other is expected.
TEST_F(FeatureDelayTest, FrameLostWhileAwaitedEndsTheWait) {
  delay_.Expect(1, 40'000'000);
  std::thread vision([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    delay_.Put(Measurement(2));
  });
  EXPECT_TRUE(delay_.HandOver(40'000'000, true, mailbox_));
  EXPECT_EQ(Taken(), -1);
  vision.join();
}

TEST_F(FeatureDelayTest, EndOfVisionEndsTheWait) {
  delay_.Expect(1, 40'000'000);
  delay_.Close();
  EXPECT_FALSE(delay_.HandOver(40'000'000, true, mailbox_));
}

}  // namespace
}  // namespace fovea::sim
