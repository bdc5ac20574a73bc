// SPDX-License-Identifier: Apache-2.0
// Requirements for every clock. A fixture has `hal::Clock& clock()`.
#pragma once

#include <gtest/gtest.h>

#include "fovea/hal/clock.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::test {

template <typename Fixture>
class ClockContract : public testing::Test {
 protected:
  Fixture fixture_;
};

TYPED_TEST_SUITE_P(ClockContract);

TYPED_TEST_P(ClockContract, NeverGoesBack) {
  hal::Clock& clock = this->fixture_.clock();
  std::int64_t before = clock.NowNs();
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t now = clock.NowNs();
    ASSERT_GE(now, before);
    before = now;
  }
}

TYPED_TEST_P(ClockContract, WaitsAtLeastUntilTheDeadline) {
  hal::Clock& clock = this->fixture_.clock();
  for (int i = 1; i <= 5; ++i) {
    const std::int64_t deadline = clock.NowNs() / hal::kNsPerMs * hal::kNsPerMs + i * hal::kNsPerMs;
    ASSERT_TRUE(clock.WaitUntil(deadline).ok());
    EXPECT_GE(clock.NowNs(), deadline);
  }
}

TYPED_TEST_P(ClockContract, ReturnsAtOnceWhenTheDeadlineHasPassed) {
  hal::Clock& clock = this->fixture_.clock();
  ASSERT_TRUE(clock.WaitUntil(clock.NowNs() + 2 * hal::kNsPerMs).ok());
  const std::int64_t now = clock.NowNs();
  EXPECT_TRUE(clock.WaitUntil(now - hal::kNsPerMs).ok());
  EXPECT_TRUE(clock.WaitUntil(-1).ok());
  EXPECT_TRUE(clock.WaitUntil(0).ok());
  EXPECT_GE(clock.NowNs(), now);
}

REGISTER_TYPED_TEST_SUITE_P(ClockContract, NeverGoesBack, WaitsAtLeastUntilTheDeadline,
                            ReturnsAtOnceWhenTheDeadlineHasPassed);

}  // namespace fovea::test
