// SPDX-License-Identifier: Apache-2.0
// Requests of one thread through the box: the last value of each key, in turn.
#include "firmware/core/task/tuning_box.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fovea::task {
namespace {

TEST(TuningBoxTest, IsLockFree) {
  EXPECT_TRUE(std::atomic<double>::is_always_lock_free);
  EXPECT_TRUE(std::atomic<std::uint32_t>::is_always_lock_free);
}

TEST(TuningBoxTest, LastValueOfEachKeyWins) {
  TuningBox box;
  EXPECT_FALSE(box.Take().IsAsked());
  EXPECT_TRUE(box.Put({3, 1.0}));
  EXPECT_TRUE(box.Put({15, 2.0}));
  EXPECT_TRUE(box.Put({3, 4.0}));
  config::Tuning first = box.Take();
  EXPECT_EQ(first.key, 3);
  EXPECT_EQ(first.value, 4.0);
  config::Tuning second = box.Take();
  EXPECT_EQ(second.key, 15);
  EXPECT_EQ(second.value, 2.0);
  EXPECT_FALSE(box.Take().IsAsked());
}

TEST(TuningBoxTest, NumberWithoutRoomIsRefused) {
  TuningBox box;
  EXPECT_FALSE(box.Put({config::Tuning::kNone, 1.0}));
  EXPECT_FALSE(box.Put({config::kMostTunable, 1.0}));
  EXPECT_FALSE(box.Take().IsAsked());
}

// A key that is requested all the time does not keep the others waiting.
TEST(TuningBoxTest, KeysTakeTurns) {
  TuningBox box;
  for (int key = 0; key < config::kMostTunable; ++key) {
    EXPECT_TRUE(box.Put({key, 0.0}));
  }
  std::vector<int> seen(config::kMostTunable, 0);
  for (int tick = 0; tick < 2 * config::kMostTunable; ++tick) {
    EXPECT_TRUE(box.Put({0, 1.0}));
    EXPECT_TRUE(box.Put({config::kMostTunable - 1, 1.0}));
    ++seen.at(static_cast<std::size_t>(box.Take().key));
  }
  for (int key = 0; key < config::kMostTunable; ++key) {
    EXPECT_GE(seen[static_cast<std::size_t>(key)], 1) << key;
  }
}

}  // namespace
}  // namespace fovea::task
