// SPDX-License-Identifier: Apache-2.0
// What a change of mode resets, and what it keeps.
#include "firmware/core/task/enter_mode.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace fovea::task {
namespace {

class EnterModeTest : public testing::Test {
 protected:
  void Enter(hal::Mode before, hal::Mode now) {
    state_->mode.mode = now;
    EnterMode({7, true, before}, *state_);
  }

  std::unique_ptr<ServoState> state_ = std::make_unique<ServoState>();  // large
};

TEST_F(EnterModeTest, EveryModeChangeSetsItsTimeAndResetsResolvedMotion) {
  for (int mode = 0; mode < hal::kNumModes; ++mode) {
    state_->now_ns = 1000 + mode;
    state_->resolved.watch.sigma = 0.5;
    Enter(hal::Mode::kHold, static_cast<hal::Mode>(mode));
    EXPECT_EQ(state_->mode_since_ns, 1000 + mode);
    EXPECT_EQ(state_->resolved.watch.sigma, control::ResolvedMotion{}.watch.sigma);
  }
}

TEST_F(EnterModeTest, TrackFromHoldResetsTheAttemptAndFromCoastKeepsIt) {
  state_->now_ns = 50;
  state_->reach.blocked_ns = 7;
  state_->eye.doubted = true;
  Enter(hal::Mode::kCoast, hal::Mode::kTrack);
  EXPECT_EQ(state_->reach.blocked_ns, 7);
  EXPECT_TRUE(state_->eye.doubted);
  EXPECT_EQ(state_->track_since_ns, 0);
  Enter(hal::Mode::kHold, hal::Mode::kTrack);
  EXPECT_EQ(state_->reach.blocked_ns, 0);
  EXPECT_FALSE(state_->eye.doubted);
  EXPECT_EQ(state_->track_since_ns, 50);
}

TEST_F(EnterModeTest, HoldKeepsTheTargetUnlessItWasLost) {
  state_->prediction.p_BO = {0.4, 0.1, 0.2};
  state_->predict.knowledge = estimate::Knowledge::kKnown;
  state_->mode.hold_reason = hal::HoldReason::kGoalUnreachable;
  Enter(hal::Mode::kTrack, hal::Mode::kHold);
  EXPECT_EQ(state_->reach.p_BO_unreachable, state_->prediction.p_BO);
  EXPECT_EQ(state_->predict.knowledge, estimate::Knowledge::kKnown);
  state_->mode.hold_reason = hal::HoldReason::kTargetLost;
  Enter(hal::Mode::kTrack, hal::Mode::kHold);
  EXPECT_EQ(state_->predict.knowledge, estimate::Knowledge::kNone);
}

TEST_F(EnterModeTest, BootResetsHoldInputsAndStop) {
  state_->holds = true;
  state_->inputs.sound_ticks = 99;
  state_->fault_joint = 3;
  state_->stop.stage = guard::FaultStop::Stage::kBraked;
  state_->encoders.drove = true;
  Enter(hal::Mode::kFault, hal::Mode::kBoot);
  EXPECT_FALSE(state_->holds);
  EXPECT_EQ(state_->inputs.sound_ticks, 0);
  EXPECT_EQ(state_->fault_joint, -1);
  EXPECT_EQ(state_->stop.stage, guard::FaultStop::Stage::kDamped);
  EXPECT_FALSE(state_->encoders.drove);
}

}  // namespace
}  // namespace fovea::task
