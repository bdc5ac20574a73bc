// SPDX-License-Identifier: Apache-2.0
// Every edge of the mode table. No path leads from Fault to motion without a reset.
#include "firmware/core/task/modes.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace fovea::task {
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

  config::PredictConfig config_;
  ModeState last_;
};

TEST_F(ModesTest, BootWaitsForAReadyArm) {
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

TEST_F(ModesTest, TrackCoastAndHoldFollowTheFeatureAge) {
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

TEST_F(ModesTest, HoldRequestStopsTrackingAndLasts) {
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    ModeInputs inputs = Seen(kFresh);
    inputs.request = Request::kHold;
    EXPECT_EQ(After(In(mode), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kNotAsked);
    EXPECT_EQ(After(last_, Seen(kFresh)), Mode::kHold);
  }
}

TEST_F(ModesTest, UnreachableGoalHoldsUntilTheTargetMoves) {
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    ModeInputs inputs = Seen(kFresh);
    inputs.goal_unreachable = true;
    EXPECT_EQ(After(In(mode), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kGoalUnreachable);
    EXPECT_EQ(After(last_, Seen(kFresh)), Mode::kHold);
    ModeInputs moved = Seen(kFresh);
    moved.may_try_again = true;
    EXPECT_EQ(After(last_, moved), Mode::kTrack);
  }
}

TEST_F(ModesTest, FaultLatchesFromEveryModeAndKeepsItsFirstCause) {
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

// A request to track must be made again after the fault.
TEST_F(ModesTest, FaultClearsTheTrackRequest) {
  ModeInputs fault = Seen(kFresh);
  fault.fault = Fault::kNotFollowing;
  ASSERT_EQ(After(In(Mode::kTrack), fault), Mode::kFault);
  EXPECT_FALSE(last_.track_asked);
  ModeInputs track = Seen(kFresh);
  track.request = Request::kTrack;
  ASSERT_EQ(After(last_, track), Mode::kFault);
  EXPECT_FALSE(last_.track_asked) << "a request during the fault does not count";
  ModeInputs reset = Seen(kFresh);
  reset.request = Request::kReset;
  ASSERT_EQ(After(last_, reset), Mode::kBoot);
  ModeInputs ready = Seen(kFresh);
  ready.arm_ready = true;
  ASSERT_EQ(After(last_, ready), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kNotAsked);
  ASSERT_EQ(After(last_, ready), Mode::kHold);
  EXPECT_EQ(After(last_, track), Mode::kTrack);
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
        << "a reset in another mode has no effect";
  }
}

TEST_F(ModesTest, CommandedMotionIsFollowedUntilItsEnd) {
  ModeInputs motion;
  motion.motion_asked = true;
  EXPECT_EQ(After(In(Mode::kHold, false), motion), Mode::kMove);
  EXPECT_EQ(After(last_, motion), Mode::kMove);
  EXPECT_EQ(After(last_, ModeInputs{}), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kMotionDone);
  EXPECT_EQ(After(last_, motion), Mode::kMove) << "a second motion is accepted";
  EXPECT_EQ(After(In(Mode::kHold, true), motion), Mode::kHold) << "not while tracking is requested";
}

TEST_F(ModesTest, StoppedMotionIsNotResumed) {
  ModeInputs motion;
  motion.motion_asked = true;
  ModeInputs refused = motion;
  refused.motion_refused = true;
  ModeInputs astray = motion;
  astray.motion_not_followed = true;
  ModeInputs hold = motion;
  hold.request = Request::kHold;
  for (const auto& [inputs, reason] : {std::pair{refused, HoldReason::kMotionRefused},
                                       {astray, HoldReason::kNotFollowed},
                                       {hold, HoldReason::kNotAsked}}) {
    EXPECT_EQ(After(In(Mode::kMove, false), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, reason);
    EXPECT_EQ(After(last_, motion), Mode::kHold) << "a stream that goes on does not restart the motion";
    EXPECT_EQ(After(last_, motion), Mode::kHold);
    EXPECT_EQ(After(last_, ModeInputs{}), Mode::kHold);
    EXPECT_EQ(After(last_, motion), Mode::kMove) << "a new stream restarts the motion";
  }
  ModeInputs track = Seen(kFresh);
  track.motion_asked = true;
  track.request = Request::kTrack;
  EXPECT_EQ(After(In(Mode::kMove, false), track), Mode::kHold) << "the arm stands first";
  EXPECT_EQ(After(last_, track), Mode::kTrack);
}

// An eye that is only suspected goes on; once it has lost the target, nothing starts again by itself.
TEST_F(ModesTest, ASuspectedEyeCountsOnceItHasLostTheTarget) {
  ModeInputs inputs = Seen(kFresh);
  inputs.eye_suspected = true;
  EXPECT_EQ(After(In(Mode::kTrack), inputs), Mode::kTrack);
  inputs.feature_age_ns = Lost();
  for (const Mode mode : {Mode::kTrack, Mode::kCoast}) {
    EXPECT_EQ(After(In(mode), inputs), Mode::kHold);
    EXPECT_EQ(last_.hold_reason, HoldReason::kEyeDoubted);
    EXPECT_EQ(After(last_, Seen(kFresh)), Mode::kHold) << "only a request starts it again";
  }
  inputs.eye_suspected = false;
  EXPECT_EQ(After(In(Mode::kTrack), inputs), Mode::kHold);
  EXPECT_EQ(last_.hold_reason, HoldReason::kTargetLost);
}

// All combinations of requests and conditions in a tick.
std::vector<ModeInputs> AllInputs(std::int64_t stale_ns, std::int64_t lost_ns) {
  std::vector<ModeInputs> all;
  for (const Request request : {Request::kNone, Request::kTrack, Request::kHold, Request::kReset}) {
    for (unsigned bits = 0; bits < 512; ++bits) {
      for (const std::int64_t age : {std::int64_t{0}, stale_ns, lost_ns}) {
        for (const Fault fault : {Fault::kNone, Fault::kArmStale}) {
          ModeInputs inputs;
          inputs.request = request;
          inputs.arm_ready = (bits & 1U) != 0;
          inputs.target_known = (bits & 2U) != 0;
          inputs.goal_unreachable = (bits & 4U) != 0;
          inputs.may_try_again = (bits & 8U) != 0;
          inputs.motion_asked = (bits & 16U) != 0;
          inputs.motion_refused = (bits & 32U) != 0;
          inputs.eye_doubted = (bits & 64U) != 0;
          inputs.motion_not_followed = (bits & 128U) != 0;
          inputs.eye_suspected = (bits & 256U) != 0;
          inputs.feature_age_ns = age;
          inputs.fault = fault;
          all.push_back(inputs);
        }
      }
    }
  }
  return all;
}

struct Less {
  bool operator()(const ModeState& a, const ModeState& b) const {
    const auto key = [](const ModeState& s) {
      return std::tuple(s.mode, s.hold_reason, s.fault, s.track_asked, s.motion_barred);
    };
    return key(a) < key(b);
  }
};

// All states that can be reached from `start` by any sequence of `inputs`. Calls `each` for every step.
template <typename Each>
std::set<ModeState, Less> Reachable(const config::PredictConfig& config, const std::vector<ModeState>& start,
                                    const std::vector<ModeInputs>& inputs, Each each) {
  std::set<ModeState, Less> seen(start.begin(), start.end());
  std::vector<ModeState> open = start;
  while (!open.empty()) {
    const ModeState before = open.back();
    open.pop_back();
    for (const ModeInputs& i : inputs) {
      ModeState after = before;
      UpdateMode(config, i, after);
      each(before, i, after);
      if (seen.insert(after).second) {
        open.push_back(after);
      }
    }
  }
  return seen;
}

// Searches all states: without a reset Fault leads to no other mode, and its cause stays.
TEST_F(ModesTest, NoWayFromFaultToMotionWithoutReset) {
  std::vector<ModeInputs> inputs = AllInputs(Stale(), Lost());
  std::erase_if(inputs, [](const ModeInputs& i) { return i.request == Request::kReset; });
  for (const bool asked : {false, true}) {
    const auto seen = Reachable(config_, {In(Mode::kFault, asked)}, inputs,
                                [](const ModeState&, const ModeInputs&, const ModeState&) {});
    for (const ModeState& state : seen) {
      ASSERT_EQ(state.mode, Mode::kFault);
      ASSERT_EQ(state.fault, Fault::kArmLost);
    }
  }
}

// From the start, with all inputs: every edge of the table occurs and no other. Boot and Fault never lead
// directly to motion, and Boot leads to Hold only with the arm ready.
TEST_F(ModesTest, ExactlyTheListedTransitionsOccur) {
  std::set<const ModeEdge*> walked;
  std::set<std::pair<Mode, Mode>> pairs;
  const auto allowed = [](Mode from, Mode to) {
    for (const ModeEdge& edge : ModeEdges()) {
      if ((edge.from_any || edge.from == from) && edge.to == to) {
        return true;
      }
    }
    return from == to;
  };
  const auto seen = Reachable(config_, {ModeState{}, In(Mode::kBoot, true)}, AllInputs(Stale(), Lost()),
                              [&](const ModeState& before, const ModeInputs& i, const ModeState& after) {
                                pairs.insert({before.mode, after.mode});
                                const bool moves = after.mode == Mode::kTrack || after.mode == Mode::kCoast ||
                                                   after.mode == Mode::kMove;
                                if (moves && (before.mode == Mode::kBoot || before.mode == Mode::kFault)) {
                                  ADD_FAILURE() << "motion directly from " << hal::Name(before.mode);
                                }
                                if (before.mode == Mode::kBoot && after.mode == Mode::kHold) {
                                  EXPECT_TRUE(i.arm_ready);
                                }
                                EXPECT_EQ(after.mode == Mode::kFault, after.fault != Fault::kNone);
                                EXPECT_EQ(after.mode == Mode::kHold, after.hold_reason != HoldReason::kNone);
                                const ModeFacts facts = FactsOf(config_, i, before);
                                for (const ModeEdge& edge : ModeEdges()) {
                                  if ((edge.from_any || edge.from == before.mode) && edge.when(facts)) {
                                    walked.insert(&edge);
                                    EXPECT_EQ(after.mode, edge.to) << edge.words;
                                    break;
                                  }
                                }
                              });
  for (const auto& [from, to] : pairs) {
    EXPECT_TRUE(allowed(from, to)) << hal::Name(from) << " to " << hal::Name(to);
  }
  for (const ModeEdge& edge : ModeEdges()) {
    EXPECT_EQ(walked.count(&edge), 1U) << hal::Name(edge.from) << ": " << edge.words << " is never taken";
  }
  std::cout << seen.size() << " states, " << walked.size() << " edges, " << pairs.size()
            << " pairs of modes\n";
}

}  // namespace
}  // namespace fovea::task
