// Every edge of the mode table, and that there is no way from Fault to motion without a reset.
#include "fovea/servo/modes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace fovea::servo {
namespace {

using hal::Fault;
using hal::HoldReason;
using hal::Mode;

class ModesTest : public testing::Test {
 protected:
  static constexpr std::int64_t kFresh = 0;
  std::int64_t Stale() const { return static_cast<std::int64_t>(config_.stale_s * 1e9) + 1; }
  std::int64_t Lost() const { return static_cast<std::int64_t>(config_.coast_s * 1e9) + 1; }

  ModeInputs Seen(std::int64_t age_ns) const {
    ModeInputs inputs;
    inputs.target_known = true;
    inputs.feature_age_ns = age_ns;
    return inputs;
  }
  ModeState In(Mode mode, bool track_asked = true, HoldReason reason = HoldReason::kNone) const {
    ModeState state;
    state.mode = mode;
    state.track_asked = track_asked;
    state.hold_reason = mode == Mode::kHold && reason == HoldReason::kNone ? HoldReason::kNoTarget : reason;
    state.fault = mode == Mode::kFault ? Fault::kArmLost : Fault::kNone;
    return state;
  }
  Mode After(ModeState state, const ModeInputs& inputs) {
    const Mode before = state.mode;
    const bool changed = UpdateMode(config_, inputs, state);
    EXPECT_EQ(changed, state.mode != before);
    EXPECT_EQ(state.mode == Mode::kHold, state.hold_reason != HoldReason::kNone)
        << "Hold always has a reason";
    last_ = state;
    return state.mode;
  }

  PredictConfig config_;
  ModeState last_;
};

TEST_F(ModesTest, BootWaitsForASoundArm) {
  ModeInputs inputs;
  EXPECT_EQ(After(In(Mode::kBoot), inputs), Mode::kBoot);
  EXPECT_EQ(After(In(Mode::kBoot), Seen(kFresh)), Mode::kBoot);
  inputs.arm_ready = true;
  EXPECT_EQ(After(In(Mode::kBoot), inputs), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kNoTarget);
  EXPECT_EQ(After(In(Mode::kBoot, false), inputs), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kNotAsked);
}

TEST_F(ModesTest, HoldGoesToTrackWhenAskedAndSeen) {
  EXPECT_EQ(After(In(Mode::kHold), Seen(kFresh)), Mode::kTrack);
  EXPECT_EQ(After(In(Mode::kHold), Seen(Stale())), Mode::kHold);
  EXPECT_EQ(After(In(Mode::kHold, false), Seen(kFresh)), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kNotAsked);
  ModeInputs ask = Seen(kFresh);
  ask.request = Request::kTrack;
  EXPECT_EQ(After(In(Mode::kHold, false), ask), Mode::kTrack);
  ModeInputs unknown;
  unknown.request = Request::kTrack;
  EXPECT_EQ(After(In(Mode::kHold, false, HoldReason::kNotAsked), unknown), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kNoTarget);
}

TEST_F(ModesTest, TrackAndCoastFollowTheAgeOfTheFeature) {
  EXPECT_EQ(After(In(Mode::kTrack), Seen(kFresh)), Mode::kTrack);
  EXPECT_EQ(After(In(Mode::kTrack), Seen(Stale())), Mode::kCoast);
  EXPECT_EQ(After(In(Mode::kCoast), Seen(Stale())), Mode::kCoast);
  EXPECT_EQ(After(In(Mode::kCoast), Seen(kFresh)), Mode::kTrack);
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    EXPECT_EQ(After(In(mode), Seen(Lost())), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kTargetLost);
    EXPECT_EQ(After(In(mode), ModeInputs{}), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kTargetLost);
  }
}

TEST_F(ModesTest, AHoldRequestStopsAndStays) {
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    ModeInputs inputs = Seen(kFresh);
    inputs.request = Request::kHold;
    EXPECT_EQ(After(In(mode), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kNotAsked);
    EXPECT_EQ(After(last_, Seen(kFresh)), Mode::kHold);
  }
}

TEST_F(ModesTest, AnUnreachableGoalHoldsUntilTheTargetMoves) {
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    ModeInputs inputs = Seen(kFresh);
    inputs.goal_unreachable = true;
    EXPECT_EQ(After(In(mode), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kGoalUnreachable);
    EXPECT_EQ(After(last_, Seen(kFresh)), Mode::kHold);
    ModeInputs moved = Seen(kFresh);
    moved.target_moved = true;
    EXPECT_EQ(After(last_, moved), Mode::kTrack);
  }
}

TEST_F(ModesTest, AFaultLatchesFromAnywhereAndKeepsItsFirstCause) {
  for (const Mode mode : {Mode::kBoot, Mode::kHold, Mode::kTrack, Mode::kCoast}) {
    ModeInputs inputs = Seen(kFresh);
    inputs.fault = Fault::kNotFollowing;
    EXPECT_EQ(After(In(mode), inputs), Mode::kFault);
    EXPECT_EQ(last_.fault, Fault::kNotFollowing);
    inputs.fault = Fault::kArmLost;
    EXPECT_EQ(After(last_, inputs), Mode::kFault);
    EXPECT_EQ(last_.fault, Fault::kNotFollowing);
  }
}

TEST_F(ModesTest, OnlyAResetWithoutAFaultLeavesFault) {
  ModeInputs reset;
  reset.request = Request::kReset;
  EXPECT_EQ(After(In(Mode::kFault), reset), Mode::kBoot);
  EXPECT_EQ(last_.fault, Fault::kNone);
  reset.fault = Fault::kArmLost;
  EXPECT_EQ(After(In(Mode::kFault), reset), Mode::kFault);
  for (const Mode mode : {Mode::kBoot, Mode::kHold, Mode::kTrack, Mode::kCoast}) {
    ModeInputs idle = Seen(kFresh);
    idle.request = Request::kReset;
    EXPECT_EQ(After(In(mode), idle), mode == Mode::kBoot ? Mode::kBoot : Mode::kTrack)
        << "a reset elsewhere means nothing";
  }
}

// All inputs there are, from every state that Fault can turn into without a reset: none moves.
TEST_F(ModesTest, NoWayFromFaultToMotionWithoutReset) {
  std::vector<ModeInputs> all;
  for (const Request request : {Request::kNone, Request::kTrack, Request::kHold}) {
    for (unsigned bits = 0; bits < 16; ++bits) {
      for (const std::int64_t age : {kFresh, Stale(), Lost()}) {
        for (const Fault fault : {Fault::kNone, Fault::kArmStale}) {
          ModeInputs inputs;
          inputs.request = request;
          inputs.arm_ready = (bits & 1U) != 0;
          inputs.target_known = (bits & 2U) != 0;
          inputs.goal_unreachable = (bits & 4U) != 0;
          inputs.target_moved = (bits & 8U) != 0;
          inputs.feature_age_ns = age;
          inputs.fault = fault;
          all.push_back(inputs);
        }
      }
    }
  }
  for (const bool asked : {false, true}) {
    for (const ModeInputs& first : all) {
      for (const ModeInputs& second : all) {
        ModeState state = In(Mode::kFault, asked);
        UpdateMode(config_, first, state);
        UpdateMode(config_, second, state);
        ASSERT_EQ(state.mode, Mode::kFault);
        ASSERT_EQ(state.fault, Fault::kArmLost);
      }
    }
  }
}

}  // namespace
}  // namespace fovea::servo
