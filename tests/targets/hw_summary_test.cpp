// What a run on hardware is judged by: how it ended, and what its camera saw last.
#include "hw_summary.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace fovea::hw {
namespace {

using hal::HoldReason;
using hal::Mode;

HwSummary Ended(Mode mode, HoldReason reason, std::optional<double> last_px) {
  HwSummary summary;
  summary.loop.ticks = 4000;
  summary.mode = mode;
  summary.modes = {{.t_s = 0.0, .mode = Mode::kBoot}, {.t_s = 3.0, .mode = mode, .reason = reason}};
  summary.seen = SeenError{.frames = 120, .frames_detected = last_px ? 110U : 0U, .last_px = last_px};
  Judge(summary);
  return summary;
}

TEST(HwSummaryTest, ATargetThatIsFollowedIsSeenAtItsGoal) {
  EXPECT_TRUE(Ended(Mode::kTrack, HoldReason::kNone, 0.2).good);
  EXPECT_FALSE(Ended(Mode::kTrack, HoldReason::kNone, 3.1).good);
  EXPECT_FALSE(Ended(Mode::kTrack, HoldReason::kNone, std::nullopt).good);
  EXPECT_FALSE(Ended(Mode::kCoast, HoldReason::kNone, 0.2).good);
}

TEST(HwSummaryTest, AHoldIsWellWhereNobodyAskedForMore) {
  EXPECT_TRUE(Ended(Mode::kHold, HoldReason::kNotAsked, std::nullopt).good);
  EXPECT_TRUE(Ended(Mode::kHold, HoldReason::kMotionDone, std::nullopt).good);
}

TEST(HwSummaryTest, AHoldForWantOfTheTargetIsNot) {
  for (const HoldReason reason :
       {HoldReason::kNoTarget, HoldReason::kTargetLost, HoldReason::kGoalUnreachable}) {
    const HwSummary summary = Ended(Mode::kHold, reason, 0.2);
    EXPECT_FALSE(summary.good);
    EXPECT_NE(summary.verdict.find(hal::Name(reason)), std::string::npos) << summary.verdict;
  }
}

TEST(HwSummaryTest, AFaultIsNeverWell) {
  HwSummary summary = Ended(Mode::kTrack, HoldReason::kNone, 0.2);
  summary.fault = hal::Fault::kArmLost;
  Judge(summary);
  EXPECT_FALSE(summary.good);
  EXPECT_NE(summary.verdict.find(hal::Name(summary.fault)), std::string::npos);
}

TEST(HwSummaryTest, ARunWithoutATickWasNone) {
  HwSummary summary = Ended(Mode::kBoot, HoldReason::kNone, std::nullopt);
  summary.loop.ticks = 0;
  Judge(summary);
  EXPECT_FALSE(summary.good);
}

}  // namespace
}  // namespace fovea::hw
