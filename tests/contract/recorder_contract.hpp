// SPDX-License-Identifier: Apache-2.0
// Requirements for every recorder. A fixture has `hal::Recorder& recorder()`, `std::vector<hal::TickRecord>
// Taken()`, which returns the records since the last call, and `std::uint64_t dropped()`.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "fovea/hal/record.hpp"

namespace fovea::test {

template <typename Fixture>
class RecorderContract : public testing::Test {
 protected:
  Fixture fixture_;
  static hal::TickRecord Make(std::uint64_t tick) {
    hal::TickRecord record;
    record.tick = tick;
    record.q_cmd.fill(static_cast<double>(tick));
    return record;
  }
};

TYPED_TEST_SUITE_P(RecorderContract);

TYPED_TEST_P(RecorderContract, KeepsEveryRecordInOrder) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    this->fixture_.recorder().Record(this->Make(i));
  }
  const std::vector<hal::TickRecord> taken = this->fixture_.Taken();
  ASSERT_EQ(taken.size(), 50U);
  for (std::uint64_t i = 0; i < 50; ++i) {
    EXPECT_EQ(taken[i].tick, i);
    EXPECT_EQ(taken[i].q_cmd[7], static_cast<double>(i));
  }
  EXPECT_EQ(this->fixture_.dropped(), 0U);
}

TYPED_TEST_P(RecorderContract, RecordsWithoutRoomAreDroppedAndCounted) {
  constexpr std::uint64_t kMany = 100'000;
  for (std::uint64_t i = 0; i < kMany; ++i) {
    this->fixture_.recorder().Record(this->Make(i));
  }
  const std::vector<hal::TickRecord> taken = this->fixture_.Taken();
  EXPECT_EQ(taken.size() + this->fixture_.dropped(), kMany);
  for (std::size_t i = 1; i < taken.size(); ++i) {
    ASSERT_GT(taken[i].tick, taken[i - 1].tick);
  }
  // Recording continues once there is room.
  this->fixture_.recorder().Record(this->Make(kMany));
  EXPECT_EQ(this->fixture_.Taken().size(), 1U);
}

REGISTER_TYPED_TEST_SUITE_P(RecorderContract, KeepsEveryRecordInOrder,
                            RecordsWithoutRoomAreDroppedAndCounted);

}  // namespace fovea::test
