// SPDX-License-Identifier: Apache-2.0
// The verdict of a hardware run: its last mode, and the last image error.
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

// At the end of the run the hold reason differs from the one that stopped the tracking.
TEST(HwSummaryTest, HoldWithADoubtedEyeIsNotConverged) {
  HwSummary summary = Ended(Mode::kHold, HoldReason::kNotAsked, 318.9);
  summary.modes.insert(summary.modes.end() - 1,
                       {{.t_s = 1.0, .mode = Mode::kTrack},
                        {.t_s = 2.0, .mode = Mode::kHold, .reason = HoldReason::kEyeDoubted}});
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_NE(summary.verdict.find("eye_doubted"), std::string::npos) << summary.verdict;
  // After tracking again and a requested hold, the old doubt does not count.
  summary.modes.insert(summary.modes.end() - 1, {.t_s = 2.5, .mode = Mode::kTrack});
  Judge(summary);
  EXPECT_EQ(summary.converged, std::nullopt);
}

TEST(HwSummaryTest, HoldForASilentOperatorIsNotConverged) {
  HwSummary summary = Ended(Mode::kHold, HoldReason::kNotAsked, 0.2);
  summary.operator_silent = true;
  Judge(summary);
  EXPECT_EQ(summary.converged, std::nullopt) << "tracking was never requested";
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
  EXPECT_NE(
      summary.verdict.find("recovered from: the arm returned errors, or nothing (arm_lost); an external "
                           "force exceeded its limit (contact)"),
      std::string::npos)
      << summary.verdict;
  EXPECT_EQ(nlohmann::json::parse(ToJson(summary))["faults_recovered"], 2);
  summary.fault = hal::Fault::kArmLost;
  Judge(summary);
  EXPECT_EQ(summary.converged, false);
  EXPECT_NE(summary.verdict.find("ended in a fault: the arm returned errors, or nothing (arm_lost)"),
            std::string::npos)
      << summary.verdict;
  EXPECT_NE(summary.verdict.find("recovered from: an external force exceeded its limit (contact)"),
            std::string::npos)
      << summary.verdict;
  EXPECT_EQ(nlohmann::json::parse(ToJson(summary))["faults_recovered"], 1);
}

TEST(HwSummaryTest, RunThatNeverLeftBootIsNotConverged) {
  HwSummary summary = Ended(Mode::kBoot, HoldReason::kNone, 0.2);
  EXPECT_EQ(summary.converged, false) << "the run stayed in Boot";
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

// Without ground truth the camera's true pose is unknown.
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
