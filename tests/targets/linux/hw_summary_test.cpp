// What a run on hardware is judged by: how it ended, and what its camera saw last.
#include "firmware/targets/linux/hw_summary.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace fovea::hw {
namespace {

using hal::HoldReason;
using hal::Mode;

HwSummary Ended(Mode mode, HoldReason reason, std::optional<double> last_px) {
  HwSummary summary;
  summary.ticks = 4000;
  summary.mode = mode;
  summary.hold_reason = reason;
  summary.modes = {{.t_s = 0.0, .mode = Mode::kBoot}, {.t_s = 3.0, .mode = mode, .reason = reason}};
  summary.seen = SeenError{.frames = 120, .frames_detected = last_px ? 110U : 0U, .last_px = last_px};
  Judge(summary);
  return summary;
}

TEST(HwSummaryTest, TrackWithinTheErrorBoundIsConverged) {
  EXPECT_EQ(Ended(Mode::kTrack, HoldReason::kNone, 0.2).converged, true);
  EXPECT_EQ(Ended(Mode::kTrack, HoldReason::kNone, 3.1).converged, false);
  EXPECT_EQ(Ended(Mode::kTrack, HoldReason::kNone, std::nullopt).converged, false);
  EXPECT_EQ(Ended(Mode::kCoast, HoldReason::kNone, 0.2).converged, false);
}

TEST(HwSummaryTest, HoldWithoutARequestIsNotJudged) {
  EXPECT_EQ(Ended(Mode::kHold, HoldReason::kNotAsked, 100.0).converged, std::nullopt);
  EXPECT_EQ(Ended(Mode::kHold, HoldReason::kMotionDone, 100.0).converged, std::nullopt);
}

TEST(HwSummaryTest, HoldWithoutTargetIsNotConverged) {
  for (const HoldReason reason :
       {HoldReason::kNoTarget, HoldReason::kTargetLost, HoldReason::kGoalUnreachable}) {
    const HwSummary summary = Ended(Mode::kHold, reason, 0.2);
    EXPECT_EQ(summary.converged, false);
    EXPECT_NE(summary.verdict.find(hal::Name(reason)), std::string::npos) << summary.verdict;
  }
}

// The end of the run leaves another reason behind the one that the arm held for.
TEST(HwSummaryTest, HoldWithADoubtedEyeIsNotConverged) {
  HwSummary summary = Ended(Mode::kHold, HoldReason::kNotAsked, 318.9);
  summary.modes.insert(summary.modes.end() - 1,
                       {{.t_s = 1.0, .mode = Mode::kTrack},
                        {.t_s = 2.0, .mode = Mode::kHold, .reason = HoldReason::kEyeDoubted}});
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_NE(summary.verdict.find("eye_doubted"), std::string::npos) << summary.verdict;
  // Tracking since then, and a hold that was asked for: nobody's doubt.
  summary.modes.insert(summary.modes.end() - 1, {.t_s = 2.5, .mode = Mode::kTrack});
  Judge(summary);
  EXPECT_EQ(summary.converged, std::nullopt);
}

TEST(HwSummaryTest, HoldForASilentOperatorIsNotConverged) {
  HwSummary summary = Ended(Mode::kHold, HoldReason::kNotAsked, 0.2);
  summary.operator_silent = true;
  Judge(summary);
  EXPECT_EQ(summary.converged, std::nullopt) << "nobody had asked for the target";
  summary.modes.insert(summary.modes.begin() + 1, {.t_s = 2.0, .mode = Mode::kTrack});
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_NE(summary.verdict.find("the operator was silent"), std::string::npos) << summary.verdict;
}

TEST(HwSummaryTest, FaultIsNotConvergedAndARecoveryIsReported) {
  HwSummary summary = Ended(Mode::kTrack, HoldReason::kNone, 0.2);
  EXPECT_EQ(summary.verdict.find("recovered"), std::string::npos);
  summary.faults = {{.t_s = 1.0, .fault = hal::Fault::kContact}, {.t_s = 2.0, .fault = hal::Fault::kArmLost}};
  Judge(summary);
  EXPECT_EQ(summary.converged, true);
  EXPECT_NE(summary.verdict.find("recovered from arm_lost, contact"), std::string::npos) << summary.verdict;
  EXPECT_EQ(nlohmann::json::parse(ToJson(summary))["faults_recovered"], 2);
  summary.fault = hal::Fault::kArmLost;
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_NE(summary.verdict.find(hal::Name(summary.fault)), std::string::npos);
  EXPECT_NE(summary.verdict.find("recovered from contact"), std::string::npos) << summary.verdict;
  EXPECT_EQ(nlohmann::json::parse(ToJson(summary))["faults_recovered"], 1);
}

TEST(HwSummaryTest, RunThatNeverLeftBootIsNotConverged) {
  HwSummary summary = Ended(Mode::kBoot, HoldReason::kNone, 0.2);
  EXPECT_EQ(summary.converged, false) << "it stayed in Boot";
  summary.ticks = 0;
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  summary = Ended(Mode::kHold, HoldReason::kNotAsked, 0.2);
  summary.ticks = 0;
  summary.refusal = "motion is refused: ...";
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_EQ(summary.verdict, summary.refusal);
}

TEST(HwSummaryTest, TargetNeverSeenIsNotConverged) {
  for (const Mode mode : {Mode::kHold, Mode::kTrack, Mode::kBoot}) {
    EXPECT_EQ(Ended(mode, HoldReason::kNotAsked, std::nullopt).converged, false);
  }
  HwSummary blind = Ended(Mode::kHold, HoldReason::kNotAsked, std::nullopt);
  blind.seen.reset();
  Judge(blind);
  EXPECT_EQ(blind.converged, std::nullopt) << "there is no camera";
}

TEST(HwSummaryTest, RunWithoutLeaveToMoveIsNotJudgedPastBoot) {
  for (const Mode mode : {Mode::kHold, Mode::kTrack}) {
    HwSummary summary = Ended(mode, HoldReason::kNotAsked, 0.2);
    summary.allow_motion = false;
    Judge(summary);
    EXPECT_EQ(summary.converged, std::nullopt);
    EXPECT_TRUE(nlohmann::json::parse(ToJson(summary))["converged"].is_null());
    summary.mode = Mode::kBoot;
    Judge(summary);
    EXPECT_EQ(summary.converged, false);
  }
}

// Nobody measured where the camera truly is.
TEST(HwSummaryTest, FiguresThatNeedTheTruthAreNullWithAReason) {
  const HwSummary summary = Ended(Mode::kTrack, HoldReason::kNone, 0.2);
  const auto json = nlohmann::json::parse(ToJson(summary));
  EXPECT_EQ(json["converged"], true);
  for (const char* key :
       {"final_error_px_rms", "final_error_mm", "final_error_depth_mm", "final_error_deg"}) {
    EXPECT_TRUE(json.at(key).is_null()) << key;
  }
  EXPECT_NE(json["unknown"]["final_error_mm"].get<std::string>().find("focal length"), std::string::npos);
  EXPECT_NE(summary.verdict.find("depth"), std::string::npos) << summary.verdict;
}

}  // namespace
}  // namespace fovea::hw
