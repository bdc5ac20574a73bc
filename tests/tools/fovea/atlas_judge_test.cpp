// SPDX-License-Identifier: Apache-2.0
// Failed starts are judged, and counted by whether a way leads from them to the goal.
#include "tools/fovea/atlas/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/support/temp_folder.hpp"
#include "tests/tools/fovea/atlas_scene.hpp"
#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/atlas/page.hpp"

namespace fovea::atlas {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// The target's centre 2 m before the camera: further than any posture of the arm.
Start WithFarGoal(Start start) {
  start.goal = Goal{{0.0, 0.0, 2.0}, {0.0, 0.0, 0.0}};
  return start;
}

TEST(AtlasJudge, FindsTheWaysThatExistTheSameWithAnyNumberOfJobs) {
  const Scene scene = test::AtlasScene("panda", "square");
  const Sampler sampler(scene);
  std::vector<Start> starts;
  for (int index = 0; index < 3; ++index) {
    starts.push_back(sampler.Draw(1, index));
  }
  starts.push_back(WithFarGoal(starts[0]));
  std::map<std::size_t, Judgement> judgements;
  JudgeStarts(scene, starts, 2, [&](std::size_t i, const Judgement& one) { judgements[i] = one; });
  ASSERT_EQ(judgements.size(), starts.size());
  int ways = 0;
  for (const auto& [i, one] : judgements) {
    std::cout << "start " << i << ": " << InWords(one) << "\n";
    const Judgement alone = JudgeStart(scene, starts[i]);
    EXPECT_EQ(alone.has_way, one.has_way);
    EXPECT_EQ(alone.length, one.length);
    EXPECT_EQ(alone.draws, one.draws);
    EXPECT_EQ(alone.goals, one.goals);
    EXPECT_EQ(one.length > 0.0, one.has_way);
    ways += one.has_way ? 1 : 0;
  }
  EXPECT_EQ(ways, 3);
  EXPECT_FALSE(judgements.at(3).has_way);
  EXPECT_EQ(InWords(judgements.at(3)), "no way found in 0 draws from 0 goal postures");
}

// With the square there, the camera has to stand where the arm is stretched out: the servo stops before.
TEST(AtlasJudge, AGoalWithoutARegularPostureHasNoWay) {
  Scene scene = test::AtlasScene("panda", "square");
  Start start;
  start.q = {2.0567, -0.8942, -2.1353, -0.8242, -1.2678, 0.4775, -1.2573};
  start.p_BO = {-0.0045, -0.4121, 0.1521};
  start.rpy_deg = {-130.75, 46.53, 26.59};
  const Judgement bounded = JudgeStart(scene, start);
  EXPECT_EQ(InWords(bounded), "no way found in 0 draws from 0 goal postures");
  scene.servo.guard.singularity_min = 0.0;
  const Judgement free = JudgeStart(scene, start, {.draws = 0});
  EXPECT_GT(free.goals, 0) << "without that bound there are some";
}

TEST(AtlasJudge, EffortBoundsTheSearch) {
  const Scene scene = test::AtlasScene("panda", "square");
  const Start start = Sampler(scene).Draw(1, 0);
  const Judgement none = JudgeStart(scene, start, {.draws = 0});
  EXPECT_FALSE(none.has_way);
  EXPECT_GT(none.goals, 0);
  EXPECT_TRUE(JudgeStart(scene, start).has_way);
}

Row Ended(int index, bool converged, const std::string& mode, const std::string& reason) {
  Row row;
  row.index = index;
  row.converged = converged;
  row.verdict = converged ? "converged" : "not converged: why";
  row.limits["joint_velocity"] = 0.5;
  row.end_mode = mode;
  row.end_reason = reason;
  row.start.q = {0.0};
  return row;
}

// Of six runs: three converge, one fails with a way, two have no way.
std::map<int, Row> SixRuns(const std::string& last_end) {
  return {{0, Ended(0, true, "track", "")},
          {1, Ended(1, true, "track", "")},
          {2, Ended(2, true, "track", "")},
          {3, Ended(3, false, "hold", "goal_unreachable")},
          {4, Ended(4, false, "hold", "goal_unreachable")},
          {5, Ended(5, false, last_end, last_end == "hold" ? "goal_unreachable" : "")}};
}
const std::map<int, Judgement> kJudgements{
    {3, {true, 5.2, 900, 31}}, {4, {false, 0.0, 240000, 12}}, {5, {false, 0.0, 240000, 7}}};

TEST(AtlasFigures, RateIsOfTheStartsWithAWay) {
  const Heading heading{"square", 7, {}, "0123456789abcdef", {}, ""};
  const Figures f = Summarise(heading, "square", SixRuns("hold"), kJudgements, 6);
  const json told = json::parse(ToJson(f));
  EXPECT_EQ(told["runs"], 6);
  EXPECT_EQ(told["converged"], 3);
  EXPECT_EQ(told["with_way"], 4);
  EXPECT_EQ(told["failed_with_way"], 1);
  EXPECT_EQ(told["success_rate"], 0.75);
  EXPECT_EQ(told["wilson_95"].get<decltype(f.wilson_95)>(), Wilson95(3, 4));
  EXPECT_EQ(told["without_way"]["runs"], 2);
  EXPECT_EQ(told["without_way"]["held_with_goal_unreachable"], 2);
  EXPECT_EQ(told["without_way"]["starts"][1]["draws"], 240000);
  EXPECT_EQ(told["without_way"]["starts"][1]["goal_postures"], 7);
  ASSERT_EQ(told["failures"].size(), 1U);
  EXPECT_EQ(told["failures"][0]["run"], 3);
  EXPECT_EQ(told["failures"][0]["way"], "a way of 5.2 rad exists");
  EXPECT_THAT(told["failures"][0]["command"], HasSubstr("fovea-sim run square --seed"));
  EXPECT_FALSE(f.ReachedGoal());
  const std::string page =
      AtlasPage(test::SourceRoot() / "firmware/host/report/page").Make(f, SixRuns("hold"));
  for (const std::string& text : {ToTable(f), page}) {
    EXPECT_THAT(text, HasSubstr("3 of 4 with a way"));
    EXPECT_THAT(text, HasSubstr("a way of 5.2 rad exists"));
    EXPECT_THAT(text, HasSubstr("2, all held with goal_unreachable"));
    EXPECT_THAT(text, HasSubstr("no way found in 240000 draws from 7 goal postures"));
  }
}

// A start without a way is excused only if its run stopped and said why.
TEST(AtlasFigures, RunWithoutAWayHasToHold) {
  std::map<int, Row> rows = SixRuns("hold");
  rows.erase(3);
  EXPECT_TRUE(Summarise({}, "square", rows, kJudgements, 6).ReachedGoal());
  rows.at(5) = SixRuns("track").at(5);
  const Figures tracks = Summarise({}, "square", rows, kJudgements, 6);
  EXPECT_FALSE(tracks.ReachedGoal());
  ASSERT_EQ(tracks.failures.size(), 1U);
  EXPECT_EQ(tracks.failures[0].index, 5);
  EXPECT_THAT(ToTable(tracks), HasSubstr("2, only 1 held with goal_unreachable"));
  EXPECT_THAT(ToTable(tracks), HasSubstr("the run has to end in Hold"));
  rows.at(5) = Ended(5, false, "hold", "target_lost");
  EXPECT_FALSE(Summarise({}, "square", rows, kJudgements, 6).ReachedGoal());
  rows.at(5) = SixRuns("hold").at(5);
  rows.at(5).limit_violations = 1;
  EXPECT_EQ(Summarise({}, "square", rows, kJudgements, 6).held, 1);
}

TEST(AtlasRows, JudgementsAreKept) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "rows.jsonl";
  const Heading heading{"square", 7, {}, "0123", {}, ""};
  {
    RowFile rows(file, heading, false);
    rows.Add(SixRuns("track").at(5));
    rows.Add(5, kJudgements.at(5));
  }
  const RowFile rows(file, heading, true);
  ASSERT_EQ(rows.judgements().size(), 1U);
  EXPECT_FALSE(rows.judgements().at(5).has_way);
  EXPECT_EQ(rows.judgements().at(5).draws, 240000);
  EXPECT_EQ(rows.judgements().at(5).goals, 7);
  EXPECT_EQ(rows.rows().at(5).end_mode, "track");
}

}  // namespace
}  // namespace fovea::atlas
