// SPDX-License-Identifier: Apache-2.0
// The judge of the fault matrix, on synthetic summaries: each verdict is reached, and each bound is exceeded.
#include "tools/fovea/faults/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tools/fovea/faults/stages.hpp"
#include "tools/fovea/faults/table.hpp"

namespace fovea::matrix {
namespace {

using nlohmann::json;
using testing::ElementsAre;

// A run of 6 s, disturbed from 2 s to 3 s, without noise or other events.
json Summary(const std::string& fault) {
  return {
      {"modes",
       {{{"t_s", 0.0}, {"mode", "boot"}, {"reason", ""}}, {{"t_s", 0.1}, {"mode", "track"}, {"reason", ""}}}},
      {"injected", {{{"name", fault}, {"from_s", 2.0}, {"to_s", 3.0}, {"noticed", {{"mode_track", 2.0}}}}}},
      {"end",
       {{"mode", "track"},
        {"reason", ""},
        {"brakes", false},
        {"at_rest_since_s", nullptr},
        {"goal_kept_since_s", 1.5}}},
      {"limits",
       {{"joint_position", 0.5},
        {"joint_velocity", 0.8},
        {"torque", 0.2},
        {"torque_rate", 1.0},
        {"workspace", 0.9}}},
      {"violations", json::object()},
      {"unwanted_motion",
       {{"boot",
         {{"most_mm", 0.1}, {"beyond_stop_mm", 0.1}, {"most_m_per_s", 0.01}, {"gained_m_per_s", 0.01}}}}},
      {"contact_ticks", 0},
      {"sim_time_s", 6.0}};
}

class FaultJudge : public testing::Test {
 protected:
  json& noticed() { return run_["injected"][0]["noticed"]; }
  json& end() { return run_["end"]; }
  void Mode(double t_s, const std::string& mode, const std::string& reason = "") {
    run_["modes"].push_back({{"t_s", t_s}, {"mode", mode}, {"reason", reason}});
    end()["mode"] = mode;
    end()["reason"] = reason;
    noticed().emplace("mode_" + mode, t_s);
  }
  [[nodiscard]] Outcome Judged() const { return Judge("freeze", run_, without_, kept_s_); }

  double kept_s_ = 0.5;
  json run_ = Summary("freeze");
  json without_ = Summary("nothing");
};

TEST_F(FaultJudge, UndetectedFaultWithoutEffectCountsAsRecovered) {
  const Outcome o = Judged();
  EXPECT_EQ(o.noticed_by, "");
  EXPECT_FALSE(o.ticks.has_value());
  EXPECT_EQ(o.reaction, "");
  EXPECT_EQ(o.end, End::kRecovered);
  EXPECT_EQ(*o.recovered_after_s, 0.0);
  EXPECT_FALSE(o.Failed());
}

TEST_F(FaultJudge, ReportsTheFirstDetectionAndTheOutcome) {
  noticed()["measurement_left_out"] = 2.04;
  Mode(2.19, "coast");
  Mode(2.7, "track");
  end()["goal_kept_since_s"] = 4.25;
  const Outcome o = Judged();
  EXPECT_EQ(o.noticed_by, "measurement_left_out");
  EXPECT_EQ(*o.ticks, 40);
  EXPECT_EQ(o.reaction, "coast, track");
  EXPECT_EQ(o.end, End::kRecovered);
  EXPECT_NEAR(*o.recovered_after_s, 1.25, 1e-12);
}

TEST_F(FaultJudge, EventAlsoWithoutTheFaultIsNoDetection) {
  for (json* summary : {&run_, &without_}) {
    (*summary)["injected"][0]["noticed"]["limit_joint_jerk"] = 2.1;
    (*summary)["injected"][0]["noticed"]["target_not_found"] = 2.0;
  }
  EXPECT_FALSE(Judged().ticks.has_value());
  noticed()["limit_torque"] = 2.3;  // only a limit
  EXPECT_EQ(Judged().noticed_by, "limit torque");
  EXPECT_EQ(*Judged().ticks, 300);
  EXPECT_EQ(Judged().reaction, "limit torque");
  noticed()["state_missing"] = 2.5;  // a guard takes precedence, even if later
  EXPECT_EQ(Judged().noticed_by, "state_missing");
}

TEST_F(FaultJudge, ProlongedModeIsADetection) {
  noticed() = {{"mode_boot", 2.0}, {"mode_hold", 2.6}};
  without_["injected"][0]["noticed"] = {{"mode_boot", 2.0}, {"mode_hold", 2.01}};
  EXPECT_EQ(Judged().noticed_by, "boot goes on");
  EXPECT_EQ(*Judged().ticks, 10);
  noticed() = {{"mode_boot", 2.0}, {"mode_hold", 2.011}};
  EXPECT_EQ(Judged().noticed_by, "") << "one tick is within the tolerance";
  without_["injected"][0]["noticed"]["mode_track"] = 2.118;
  EXPECT_EQ(Judged().noticed_by, "hold goes on");
  EXPECT_EQ(*Judged().ticks, 118);
  noticed()["mode_track"] = 2.118;
  EXPECT_EQ(Judged().noticed_by, "");
}

TEST_F(FaultJudge, SafeStopNeedsBrakesAndRest) {
  noticed()["fault_arm_lost"] = 2.019;
  Mode(2.019, "fault");
  end()["brakes"] = true;
  end()["at_rest_since_s"] = 2.2;
  end()["goal_kept_since_s"] = nullptr;
  EXPECT_EQ(Judged().noticed_by, "arm_lost");
  EXPECT_EQ(*Judged().ticks, 19);
  EXPECT_EQ(Judged().end, End::kSafeStop);
  EXPECT_FALSE(Judged().Failed());
  end()["goal_kept_since_s"] = 1.5;  // a stop at the goal is still a stop
  EXPECT_EQ(Judged().end, End::kSafeStop);
  end()["brakes"] = false;
  EXPECT_EQ(Judged().end, End::kUndefined);
  end()["brakes"] = true;
  end()["at_rest_since_s"] = nullptr;
  EXPECT_EQ(Judged().end, End::kUndefined);
  EXPECT_TRUE(Judged().Failed());
  EXPECT_FALSE(Judged().is_on_its_way) << "the arm should be at rest by now";
}

TEST_F(FaultJudge, HeldNeedsHoldAndRest) {
  Mode(2.6, "hold", "target_lost");
  end()["goal_kept_since_s"] = nullptr;
  end()["at_rest_since_s"] = 2.9;
  EXPECT_EQ(Judged().end, End::kHeld);
  EXPECT_EQ(Judged().end_detail, "hold (target_lost)");
  end()["at_rest_since_s"] = nullptr;
  EXPECT_EQ(Judged().end, End::kUndefined);
}

TEST_F(FaultJudge, EveryOtherEndIsUndefined) {
  end()["goal_kept_since_s"] = nullptr;  // tracks, but misses the goal
  EXPECT_EQ(Judged().end, End::kUndefined);
  EXPECT_TRUE(Judged().Failed());
  EXPECT_TRUE(Judged().is_on_its_way);
  end()["goal_kept_since_s"] = 5.6;  // kept for less than kept_s_
  EXPECT_EQ(Judged().end, End::kUndefined);
  run_["injected"][0]["to_s"] = 6.0;
  EXPECT_FALSE(Judged().is_on_its_way) << "the fault lasts to the end: more time would not help";
  run_["injected"][0]["to_s"] = 3.0;
  end()["goal_kept_since_s"] = 5.5;
  EXPECT_EQ(Judged().end, End::kRecovered);
  EXPECT_FALSE(Judged().is_on_its_way);
  end()["goal_kept_since_s"] = 5.9;
  kept_s_ = 0.0;  // the error is already a mean over half a second
  EXPECT_EQ(Judged().end, End::kRecovered);
  Mode(5.0, "boot");  // at the goal by chance, without tracking
  EXPECT_EQ(Judged().end, End::kUndefined);
}

TEST_F(FaultJudge, ExceedingAnyArmLimitFails) {
  for (const std::string& limit : PhysicalLimits()) {
    run_ = Summary("freeze");
    run_["limits"][limit] = 1.0 + 1e-10;
    EXPECT_FALSE(Judged().Failed()) << limit << ": rounding does not exceed a limit";
    run_["limits"][limit] = 1.001;
    EXPECT_THAT(Judged().exceeded, ElementsAre(limit));
    EXPECT_TRUE(Judged().Failed());
    EXPECT_EQ(Judged().end, End::kRecovered) << "a recovery does not excuse it";
    run_["limits"][limit] = std::nan("");
    EXPECT_THAT(Judged().exceeded, ElementsAre(limit));
  }
}

// The servo's own barriers, and any contact.
TEST_F(FaultJudge, AnyViolationByTheTruthFails) {
  for (const char* name : {"workspace", "hand.planes[0]", "hand.boxes[1]", "cartesian_speed",
                           "true_joint_acceleration", "contact_bench", "contact_target", "contact_self"}) {
    run_ = Summary("freeze");
    run_["violations"][name] = 1;
    EXPECT_THAT(Judged().exceeded, ElementsAre(name));
    EXPECT_TRUE(Judged().Failed());
  }
  run_["violations"] = {{"joint_velocity", 7}};
  run_["limits"]["joint_velocity"] = 1.2;
  EXPECT_THAT(Judged().exceeded, ElementsAre("joint_velocity")) << "listed once";
}

TEST_F(FaultJudge, MotionUnderAPermanentFaultIsNotUndefined) {
  end()["mode"] = "move";
  end()["goal_kept_since_s"] = nullptr;
  run_["path_error_mm_max"] = 1.8;
  EXPECT_EQ(Judged().end, End::kUndefined) << "the fault is over";
  run_["injected"][0]["to_s"] = 6.0;
  EXPECT_EQ(Judged().end, End::kGoesOn);
  EXPECT_EQ(Judged().off_mm, 1.8);
  EXPECT_FALSE(Judged().Failed());
  run_["path_error_mm_max"] = nullptr;
  EXPECT_EQ(Judged().end, End::kUndefined) << "no path is followed";
}

TEST_F(FaultJudge, MotionWhereTheArmShouldStandFails) {
  for (const StandBound& bound : kStandBounds) {
    json& motion = run_["unwanted_motion"][bound.mode];
    motion = {{"most_mm", 300.0},
              {"beyond_stop_mm", bound.beyond_stop_mm},
              {"most_m_per_s", 9.0},
              {"gained_m_per_s", bound.gained_by_eye_m_per_s}};
    EXPECT_FALSE(Judged().Failed()) << bound.mode;
    EXPECT_EQ(Judged().moved.at(bound.mode).mm, 300.0);
    motion["beyond_stop_mm"] = bound.beyond_stop_mm + 1.0;
    EXPECT_THAT(Judged().too_far, ElementsAre(testing::HasSubstr(bound.mode)));
    EXPECT_TRUE(Judged().Failed());
    motion["beyond_stop_mm"] = 0.0;
    motion["gained_m_per_s"] = bound.gained_by_eye_m_per_s + 0.01;
    EXPECT_TRUE(Judged().Failed());
    motion["gained_m_per_s"] = 0.0;
  }
}

TEST_F(FaultJudge, IncompleteOrMismatchedSummaryIsRefused) {
  EXPECT_THROW((void)Judge("glare", run_, without_, kept_s_), std::runtime_error);
  EXPECT_THROW((void)Judge("freeze", run_, run_, kept_s_), std::runtime_error);
  without_["injected"][0]["from_s"] = 1.0;
  EXPECT_THROW((void)Judged(), std::runtime_error);
  without_ = Summary("nothing");
  run_["limits"].erase("torque_rate");
  EXPECT_THROW((void)Judged(), std::runtime_error);
  run_ = Summary("freeze");
  run_.erase("end");
  EXPECT_THROW((void)Judged(), std::runtime_error);
}

TEST(FaultTable, ListsEveryFaultAndNoCellTwice) {
  std::vector<std::string> ids;
  for (const Fault& fault : Faults()) {
    ids.emplace_back(fault.id);
    EXPECT_GE(fault.levels.size(), 3U);
    EXPECT_LE(fault.levels.size(), kSeverities.size());
    EXPECT_EQ(&FaultOf(fault.id), &fault);
    for (const FaultLevel& level : fault.levels) {
      EXPECT_GT(level.lasts_s, 0.0);
      EXPECT_TRUE(level.lasts_s <= 5.0 || level.lasts_s == kForever) << "the undisturbed runs are not longer";
      EXPECT_STRNE(level.figures, "");
      EXPECT_STRNE(level.why, "");
    }
  }
  EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), ids.size());
  EXPECT_THAT(ids,
              testing::IsSupersetOf({"frame_loss", "freeze", "freeze_pixels", "replay", "mirror", "stamp",
                                     "latency", "occluder", "glare", "wrong_detection", "encoder_stuck",
                                     "encoders_stuck", "encoder_noise", "torque_loss", "packet_loss",
                                     "clock_jump", "load", "load_from_start", "gravity"}));
}

TEST(FaultStages, FaultFromTheStartBeginsWithTheFirstTick) {
  const RunMode& mode = RunModes()[0];
  const Fault& load = FaultOf("load_from_start");
  for (const Stage stage : kStages) {
    EXPECT_EQ(MakesSense(mode, stage, load), stage == Stage::kBoot);
  }
  const StageSetup setup = matrix::SetUp(TimesOf(mode, Summary("nothing")), Stage::kBoot, &load);
  EXPECT_EQ(setup.onset_s, 0.0);
  EXPECT_NE(setup.name, matrix::SetUp(TimesOf(mode, Summary("nothing")), Stage::kBoot, &FaultOf("load")).name)
      << "it has its own undisturbed run";
}

TEST(FaultStages, StageTimesComeFromAnUndisturbedRun) {
  json summary = Summary("nothing");
  const RunMode& mode = RunModes()[0];
  const StageTimes times = TimesOf(mode, summary);
  EXPECT_NEAR(times.boot_s, 0.05, 1e-12);
  EXPECT_NEAR(times.approach_s, 0.1 + mode.approach_share * 1.4, 1e-12);
  EXPECT_NEAR(times.tracking_s, 1.5 + mode.settled_s, 1e-12);
  const Fault& occluder = FaultOf("occluder");
  EXPECT_THAT(matrix::SetUp(times, Stage::kCoasting, &occluder).assignments, testing::SizeIs(1))
      << "the camera's outage";
  const StageSetup coasting = matrix::SetUp(times, Stage::kCoasting, &Faults()[0]);
  EXPECT_THAT(coasting.assignments[0], testing::HasSubstr("faults.occluder_s="));
  EXPECT_NEAR(coasting.onset_s, times.approach_s + 0.25, 1e-12);
  summary["verdict"] = "not converged";
  summary["end"]["goal_kept_since_s"] = nullptr;
  EXPECT_THROW((void)TimesOf(mode, summary), std::runtime_error);
}

}  // namespace
}  // namespace fovea::matrix
