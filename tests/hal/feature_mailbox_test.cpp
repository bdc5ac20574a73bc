// SPDX-License-Identifier: Apache-2.0
// Hand-over from camera to servo: the newest measurement wins and is never torn.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "fovea/hal/feature.hpp"

namespace fovea::hal {
namespace {

// A measurement with the same number in all fields, so that a torn one is detected.
FeatureMeasurement Make(std::uint64_t sequence) {
  FeatureMeasurement m;
  m.sequence = sequence;
  m.stamp_ns = static_cast<std::int64_t>(sequence) * 1000;
  m.s.fill(static_cast<double>(sequence));
  m.cov_s.fill(static_cast<double>(sequence));
  return m;
}

bool IsWhole(const FeatureMeasurement& m) {
  const auto expected = static_cast<double>(m.sequence);
  for (const double value : m.s) {
    if (value != expected) {
      return false;
    }
  }
  for (const double value : m.cov_s) {
    if (value != expected) {
      return false;
    }
  }
  return m.stamp_ns == static_cast<std::int64_t>(m.sequence) * 1000;
}

TEST(FeatureMailboxTest, IsEmptyAtFirstAndAfterTaking) {
  FeatureMailbox mailbox;
  FeatureMeasurement m = Make(7);
  EXPECT_FALSE(mailbox.Take(m));
  EXPECT_EQ(m.sequence, 7U);  // untouched
  mailbox.Put(Make(1));
  EXPECT_TRUE(mailbox.Take(m));
  EXPECT_EQ(m.sequence, 1U);
  EXPECT_FALSE(mailbox.Take(m));
}

TEST(FeatureMailboxTest, TakeReturnsTheNewest) {
  FeatureMailbox mailbox;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    mailbox.Put(Make(i));
  }
  FeatureMeasurement m;
  EXPECT_TRUE(mailbox.Take(m));
  EXPECT_EQ(m.sequence, 5U);
  EXPECT_FALSE(mailbox.Take(m));
}

// A wrong stamp in the future must not block later features.
TEST(FeatureMailboxTest, FutureStampDoesNotBlockLaterFeatures) {
  FeatureMailbox mailbox;
  FeatureMeasurement odd = Make(5);
  odd.stamp_ns = INT64_MAX;
  mailbox.Put(odd);
  mailbox.Put(Make(6));
  FeatureMeasurement m;
  EXPECT_TRUE(mailbox.Take(m));
  EXPECT_EQ(m.sequence, 6U);
}

TEST(FeatureMailboxTest, TwoThreadsNeverSeeATornFeature) {
  constexpr std::uint64_t kCount = 300'000;
  FeatureMailbox mailbox;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      mailbox.Put(Make(i));
    }
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t taken = 0;
  bool whole = true;
  bool forward = true;
  FeatureMeasurement m;
  const auto take_one = [&] {
    if (!mailbox.Take(m)) {
      return false;
    }
    ++taken;
    whole = whole && IsWhole(m);
    forward = forward && m.sequence > last;
    last = m.sequence;
    return true;
  };
  while (!done) {
    take_one();
  }
  take_one();
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(forward);
  EXPECT_EQ(last, kCount);  // the newest is never lost
  EXPECT_GT(taken, 0U);
}

}  // namespace
}  // namespace fovea::hal
