// SPDX-License-Identifier: Apache-2.0
// A goal that limits keep out of reach, and when the servo tries it again.
#include "firmware/core/control/reach_watch.hpp"

#include <gtest/gtest.h>

namespace fovea::control {
namespace {

TEST(ReachWatchTest, GoalIsUnreachableAfterTheConfiguredBlockedTime) {
  config::LawConfig config;
  config.unreachable_s = 0.5;
  ReachWatch watch;
  for (int tick = 0; tick < 500; ++tick) {
    UpdateBlockedTime(true, watch);
  }
  EXPECT_FALSE(IsUnreachable(config, watch));
  UpdateBlockedTime(true, watch);
  EXPECT_TRUE(IsUnreachable(config, watch));
}

// Each free tick cancels a blocked one: with nine of ten ticks blocked it takes 10 / 8 as long.
TEST(ReachWatchTest, UnblockedTickTakesOneBlockedTickOff) {
  config::LawConfig config;
  config.unreachable_s = 0.4;
  ReachWatch watch;
  int ticks = 0;
  while (!IsUnreachable(config, watch) && ticks < 10'000) {
    UpdateBlockedTime(ticks % 10 != 0, watch);
    ++ticks;
  }
  EXPECT_NEAR(ticks, 500, 10);
}

TEST(ReachWatchTest, LongUnblockedTimeGivesNoCredit) {
  config::LawConfig config;
  config.unreachable_s = 0.1;
  ReachWatch watch;
  for (int tick = 0; tick < 1000; ++tick) {
    UpdateBlockedTime(false, watch);
  }
  for (int tick = 0; tick <= 100; ++tick) {
    UpdateBlockedTime(true, watch);
  }
  EXPECT_TRUE(IsUnreachable(config, watch));
}

TEST(ReachWatchTest, TargetMovedByTwoCentimetresIsTriedAgain) {
  ReachWatch watch;
  watch.p_BO_unreachable = {0.5, 0.1, 0.2};
  EXPECT_FALSE(HasMoved({0.519, 0.1, 0.2}, watch));
  EXPECT_TRUE(HasMoved({0.521, 0.1, 0.2}, watch));
}

}  // namespace
}  // namespace fovea::control
