// SPDX-License-Identifier: Apache-2.0
// `fovea atlas`: the same figures for any number of jobs and after a kill;
// starts that match their description; errors in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "firmware/host/config/folder_lock.hpp"
#include "tests/support/program.hpp"
#include "tests/tools/fovea/atlas_scene.hpp"
#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/atlas/sampler.hpp"
#include "tools/fovea/atlas/seed.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr double kRadPerDeg = 0.017453292519943295;

std::string Content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

int CountOf(const std::string& text, const std::string& what) {
  int count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++count;
  }
  return count;
}

class AtlasTest : public testing::Test {
 protected:
  // Runs too short to converge, so that many fit into a test.
  static std::vector<std::string> Arguments(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        FOVEA_PROGRAM, "atlas", "--target", "sphere", "--set", "run.duration_s=0.15",
        "--json",      "--out", out,        "--seed", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  test::ProgramResult Atlas(const std::string& folder, const std::vector<std::string>& more) const {
    return test::RunProgram(Arguments(folder_.path() / folder, more), {}, std::chrono::seconds(300));
  }
  // The first row of rows.jsonl, behind its heading.
  json FirstRow(const std::string& folder) const {
    std::ifstream rows(folder_.path() / folder / "rows.jsonl");
    std::string line;
    std::getline(rows, line);
    std::getline(rows, line);
    return json::parse(line);
  }
  void ExpectRefused(const std::vector<std::string>& more, const std::string& says) const {
    const test::ProgramResult result = Atlas("refused", more);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr(says));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  const test::TempFolder folder_;
};

TEST_F(AtlasTest, ResultIsTheSameForAnyJobCountAndAfterAKill) {
  const test::ProgramResult one = Atlas("one", {"--runs", "3", "-j", "1"});
  ASSERT_EQ(one.exit_code, 1) << one.err;  // such short runs fail
  const json figures = json::parse(one.out);
  EXPECT_EQ(figures["runs"], 3);
  EXPECT_EQ(figures["seed_kind"], "tuning");
  EXPECT_EQ(figures["converged"], 0);
  EXPECT_EQ(figures["failures"].size(), 3U);
  EXPECT_EQ(Content(folder_.path() / "one" / "atlas.json"), one.out);
  EXPECT_THAT(Content(folder_.path() / "one" / "atlas.html"), HasSubstr("0 of 3 with a way converged"));

  // Every failed start was judged, and is not judged again.
  const std::string kept = Content(folder_.path() / "one" / "rows.jsonl");
  EXPECT_EQ(CountOf(kept, "\"judged\""), 3);
  EXPECT_EQ(Atlas("one", {"--runs", "3", "--resume"}).out, one.out);
  EXPECT_EQ(Content(folder_.path() / "one" / "rows.jsonl"), kept);
  for (const json& failure : figures["failures"]) {
    EXPECT_THAT(failure["way"], testing::MatchesRegex("a way of .* rad exists"));
  }

  const test::ProgramResult two = Atlas("two", {"--runs", "3", "-j", "2"});
  EXPECT_EQ(two.out, one.out);

  // Killed after the first run, with a truncated row.
  std::vector<std::string> words = Arguments(folder_.path() / "killed", {"--runs", "3", "-j", "1"});
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t pid = 0;
  ASSERT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  const fs::path rows = folder_.path() / "killed" / "rows.jsonl";
  const auto lines = [&] {
    const std::string text = Content(rows);
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int i = 0; i < 30000 && lines() < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  ASSERT_GE(lines(), 2);
  const std::string before = Content(rows);
  std::ofstream(rows, std::ios::app) << R"({"run":2,"start":{"q":[0.1)";
  const test::ProgramResult resumed = Atlas("killed", {"--runs", "3", "-j", "1", "--resume"});
  EXPECT_EQ(resumed.out, one.out);
  EXPECT_EQ(Content(rows).substr(0, before.size()), before) << "finished runs are not repeated";

  std::vector<std::string> of_another = Arguments(folder_.path() / "killed", {"--runs", "3", "--resume"});
  *std::find(of_another.begin(), of_another.end(), "1") = "2";
  const test::ProgramResult other = test::RunProgram(of_another);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("rows of another"));
}

// The command listed with a failure repeats its run bit-exactly.
TEST_F(AtlasTest, FailureCommandRepeatsItsRunBitExact) {
  const test::ProgramResult atlas = Atlas("atlas", {"--runs", "1"});
  const std::string command = json::parse(atlas.out)["failures"][0]["command"];
  ASSERT_EQ(command.rfind("fovea-sim ", 0), 0U) << command;
  const std::string shell = fs::path(FOVEA_PROGRAM).parent_path().string() + "/" + command +
                            " --json --no-report --out " + (folder_.path() / "again").string();
  const test::ProgramResult again = test::RunProgram({"sh", "-c", shell});
  EXPECT_EQ(json::parse(again.out)["log_hash"], FirstRow("atlas")["log_hash"]);
}

// Drawing starts only gives the same refusals as running them.
TEST_F(AtlasTest, DrawsStartsWithoutRunningThem) {
  const json runs = json::parse(Atlas("runs", {"--runs", "2"}).out);
  const test::ProgramResult draws = Atlas("draws", {"--runs", "2", "--draw-only"});
  ASSERT_EQ(draws.exit_code, 0) << draws.err;
  EXPECT_EQ(json::parse(draws.out)["sampler"], runs["sampler"]);
  EXPECT_EQ(json::parse(draws.out)["starts"], 2);
  EXPECT_FALSE(fs::exists(folder_.path() / "draws")) << "no run is started";
}

TEST_F(AtlasTest, MakesViewsThatItRunsFromTheFile) {
  const std::string file = folder_.path() / "views.csv";
  const auto make = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{FOVEA_PROGRAM, "atlas", "--target", "sphere", "--seed", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram(arguments, {}, std::chrono::seconds(300));
  };
  const test::ProgramResult made = make({"--make-views", file, "--runs", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const test::ProgramResult result = Atlas("views", {"--starts", file});
  ASSERT_EQ(result.exit_code, 1) << result.err;  // too short to converge
  EXPECT_EQ(json::parse(result.out)["runs"], 1);
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--make-views", ""},
                                               {"--make-views", file, "--out", "x"},
                                               {"--make-views", file, "--json"},
                                               {"--make-views", folder_.path() / "none" / "views.csv"}}) {
    EXPECT_EQ(make(more).exit_code, 2) << testing::PrintToString(more);
  }
}

TEST_F(AtlasTest, RefusesBadOptionsInOneLine) {
  ExpectRefused({"--set", "target.kind=circle"}, "the atlas sets target.kind itself");
  ExpectRefused({"--starts", ""}, "--starts: no file is named");
  ExpectRefused({"--runs", "1", "--set", "servo.lamda=3"}, "did you mean servo.lambda");
  fs::create_directories(folder_.path() / "refused");
  std::ofstream(folder_.path() / "refused" / "rows.jsonl") << "{}\n";
  ExpectRefused({"--resume"}, "not a row of an atlas");
  const config::FolderLock another(folder_.path() / "refused");
  ExpectRefused({}, "another run writes there");
  EXPECT_EQ(Content(folder_.path() / "refused" / "rows.jsonl"), "{}\n");
  EXPECT_EQ(Atlas("refused", {"--runs", "0"}).exit_code, 2);
  EXPECT_EQ(Atlas("refused", {"--jobs", "0"}).exit_code, 2);
  EXPECT_EQ(test::RunProgram({FOVEA_PROGRAM, "atlas", "--target", "cube"}).exit_code, 2);
  EXPECT_EQ(test::RunProgram({FOVEA_PROGRAM, "atlas"}).exit_code, 2);
}

// A run that cannot write its log says so after its progress.
TEST_F(AtlasTest, ReasonIsTheSimulatorsErrorNotItsProgress) {
  EXPECT_EQ(atlas::ReasonOf("ball:   0 %  0.0 of 0.1 s  preparing\nfovea-sim: run.mcap: cannot be written\n"),
            "run.mcap: cannot be written");
  EXPECT_EQ(atlas::ReasonOf("fovea-sim: --set: servo.goal: 3 values\n"), "servo.goal: 3 values");
  EXPECT_THAT(atlas::ReasonOf("ball:   0 %  0.0 of 0.1 s  preparing\n"), HasSubstr("is the disk full?"));
  EXPECT_THAT(atlas::ReasonOf(""), HasSubstr("is the disk full?"));
}

// Arm, camera, mount and goal follow from --set. The rows' check against the simulator's first picture fails
// if the sampler has another one.
TEST_F(AtlasTest, TakesAnyArmCameraMountAndGoal) {
  const test::ProgramResult result =
      Atlas("ur5e", {"--runs", "2", "--set", "arm.model=ur5e", "--set", "camera.width_px=800", "--set",
                     "camera.height_px=600", "--set", "camera.hfov_deg=70", "--set",
                     "camera.mount_xyz=[0.03,0.02,0.05]", "--set", "camera.mount_rpy_deg=[0,5,60]", "--set",
                     "servo.goal=[0.02,0,0.5]"});
  ASSERT_EQ(result.exit_code, 1) << result.err;  // too short to converge
  EXPECT_EQ(json::parse(result.out)["runs"], 2);
  EXPECT_EQ(FirstRow("ur5e")["start"]["q"].size(), 6U);
  ExpectRefused({"--set", "arm.model=ur6e"}, "did you mean ur5e");
}

// Runs from a file: the goal of each start reaches the simulator, and rows name the line.
TEST_F(AtlasTest, RunsGivenStarts) {
  Atlas("drawn", {"--runs", "1"});
  const json start = FirstRow("drawn")["start"];
  json given{{"goal_x", 0.0},     {"goal_y", 0.0},   {"goal_z", 0.45}, {"goal_roll", 0.0},
             {"goal_pitch", 0.0}, {"goal_yaw", 0.0}, {"seed", 5}};
  for (std::size_t i = 0; i < 7; ++i) {
    given["q" + std::to_string(i + 1)] = start["q"][i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    given[std::string("target_") + "xyz"[i]] = start["p_BO"][i];
    given[std::vector<std::string>{"target_roll", "target_pitch", "target_yaw"}[i]] = start["rpy_deg"][i];
  }
  const fs::path file = folder_.path() / "starts.json";
  std::ofstream(file) << "[\n" << given.dump() << "]\n";
  const test::ProgramResult result = Atlas("given", {"--starts", file});
  ASSERT_EQ(result.exit_code, 1) << result.err;
  const json figures = json::parse(result.out);
  EXPECT_EQ(figures["runs"], 1);
  EXPECT_EQ(figures["failures"][0]["line"], 2);
  EXPECT_THAT(figures["failures"][0]["command"], HasSubstr("--seed 5 "));
  EXPECT_THAT(figures["failures"][0]["command"], HasSubstr("servo.goal=[0,0,0.45]"));
  EXPECT_THAT(Content(folder_.path() / "given" / "rows.jsonl"), HasSubstr("\"line\":2"));
  EXPECT_THAT(Content(folder_.path() / "given" / "atlas.html"), HasSubstr("(line 2)"));

  given["q4"] = 1.0;
  std::ofstream(file) << "[\n" << given.dump() << "]\n";
  const test::ProgramResult changed = Atlas("given", {"--starts", file, "--resume"});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err, HasSubstr("starts.json:2: q4 = 1 is not allowed"));
  EXPECT_EQ(std::count(changed.err.begin(), changed.err.end(), '\n'), 1) << changed.err;
}

// Each bound is the rate at which the observed share is 1.96 deviations off.
TEST(AtlasFigures, WilsonIntervalMatchesItsDefinition) {
  for (const auto& [converged, runs] : {std::pair{198, 200}, {20, 24}, {1, 3}}) {
    const std::array<double, 2> bounds = atlas::Wilson95(converged, runs);
    const double seen = static_cast<double>(converged) / runs;
    for (const double p : bounds) {
      EXPECT_NEAR(std::fabs(seen - p) / std::sqrt(p * (1.0 - p) / runs), 1.959963984540054, 1e-9);
    }
    EXPECT_LT(bounds[0], seen);
    EXPECT_GT(bounds[1], seen);
  }
  EXPECT_NEAR(atlas::Wilson95(200, 200)[1], 1.0, 1e-12);
  EXPECT_NEAR(atlas::Wilson95(0, 10)[0], 0.0, 1e-12);
}

// A start is refused only if no servo could succeed, never for being difficult.
TEST(AtlasSampler, RefusesStartsOnlyForGeometry) {
  EXPECT_THAT(atlas::kRejectionNames,
              testing::ElementsAreArray({"start_outside_barrier", "start_near_solid", "target_near_edge",
                                         "target_out_of_reach", "target_below_table", "arm_in_the_way",
                                         "thing_in_the_way", "no_goal_posture"}));
}

TEST(AtlasFigures, GoalAllowsOneMissInAThousand) {
  atlas::Figures figures;
  figures.runs = 1000;
  figures.converged = 999;
  EXPECT_TRUE(figures.ReachedGoal());
  figures.converged = 998;
  EXPECT_FALSE(figures.ReachedGoal());
  figures.converged = 1000;
  figures.limit_violations = 1;
  EXPECT_FALSE(figures.ReachedGoal());
}

// Page, table and JSON of every target report the refusals and the seed.
TEST(AtlasFigures, RefusalsAndSeedAreReported) {
  atlas::Figures figures;
  figures.heading = {"circle", 7, {}, "0123456789abcdef", {}, ""};
  figures.runs = 10;
  figures.rejections = {11, 12, 13, 14, 15, 16, 17, 18};
  const json told = json::parse(atlas::ToJson(figures));
  const std::string table = atlas::ToTable(figures);
  const std::string page =
      atlas::AtlasPage(test::SourceRoot() / "firmware/host/report/page").Make(figures, {});
  for (std::size_t i = 0; i < atlas::kRejectionNames.size(); ++i) {
    const std::string name = atlas::kRejectionNames[i];
    EXPECT_EQ(told["sampler"]["rejected"][name], 11 + i);
    for (const std::string& text : {table, page}) {
      EXPECT_THAT(text, HasSubstr(name));
      EXPECT_THAT(text, HasSubstr(std::to_string(11 + i)));
    }
  }
  EXPECT_EQ(told["seed_kind"], "tuning");
  EXPECT_THAT(table, HasSubstr("tuning seed 7"));
  EXPECT_THAT(page, HasSubstr("tuning seed 7"));
}

TEST(AtlasSeed, EachServoHashHasItsOwnJudgingSeed) {
  const std::string hash = "0123456789abcdef";
  EXPECT_EQ(atlas::JudgingSeed(hash), 1000 + 0x0123456);
  EXPECT_NE(atlas::JudgingSeed("0123457789abcdef"), atlas::JudgingSeed(hash));
  EXPECT_EQ(atlas::JudgingSeed("fffffffff"), 1000 + 0xfffffff);
  EXPECT_STREQ(atlas::KindOfSeed(1, hash), "tuning");
  EXPECT_STREQ(atlas::KindOfSeed(999, hash), "tuning");
  EXPECT_STREQ(atlas::KindOfSeed(1000, hash), "given");
  EXPECT_STREQ(atlas::KindOfSeed(1000 + 0x0123456, hash), "judging");
}

TEST(AtlasRows, RunOfAnotherCameraIsRefused) {
  atlas::Start start;
  start.error_px = 100.0;
  json summary{{"converged", true},
               {"verdict", ""},
               {"limit_violations", 0},
               {"contact_ticks", 0},
               {"settle_time_s", 1.0},
               {"final_error_px_rms", 0.1},
               {"final_error_mm", 0.1},
               {"final_error_deg", nullptr},
               {"error_px_max", 120.0},
               {"camera_path_m", 0.4},
               {"camera_excursion_m", 0.02},
               {"limits", json::object()},
               {"log_hash", ""},
               {"truth", json::object()},
               {"start_error_px", 100.2},
               {"end", {{"mode", "hold"}, {"reason", "goal_unreachable"}}}};
  EXPECT_TRUE(atlas::MakeRow(3, start, summary).converged);
  EXPECT_TRUE(atlas::MakeRow(3, start, summary).HeldAsUnreachable());
  summary["start_error_px"] = 101.0;
  EXPECT_THROW(atlas::MakeRow(3, start, summary), std::runtime_error);
  // A true camera that is not the believed one may see the target elsewhere.
  summary["truth"]["camera.c_px"] = {{"unit", "px"}, {"believed", {320.0, 240.0}}, {"true", {320.0, 243.0}}};
  const atlas::Row row = atlas::MakeRow(3, start, summary);
  ASSERT_EQ(row.drawn.size(), 1U);
  EXPECT_EQ(row.drawn[0].key, "camera.c_px");
  EXPECT_EQ(row.drawn[0].entry, 2);
  EXPECT_EQ(row.drawn[0].actual, 243.0);
}

class AtlasStarts : public testing::TestWithParam<const char*> {};

TEST_P(AtlasStarts, DrawnStartsMatchTheirDescription) {
  const atlas::Scene scene = test::AtlasScene("panda", GetParam());
  const model::ArmModel& arm = scene.servo.arm;
  const atlas::Sampler sampler(scene);
  double least_px = 1e9;
  double least_rad = 1e9;
  double most_radius = 0.0;
  for (int index = 0; index < 60; ++index) {
    const atlas::Start start = sampler.Draw(1, index);
    model::VecN q(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      q[i] = start.q[k];
      least_rad = std::min({least_rad, q[i] - arm.joints[k].q_min, arm.joints[k].q_max - q[i]});
    }
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    most_radius = std::max(most_radius, poses.X_BE.p.norm());
    const model::Vec3 p_CO = (poses.X_BE * test::DefaultMount()).Inverse() * start.p_BO;
    EXPECT_NEAR(p_CO.z(), start.depth, 1e-9);
    EXPECT_NEAR(319.5 + 554.256 * p_CO.x() / p_CO.z(), start.u_px, 1e-3);
    EXPECT_NEAR(239.5 + 554.256 * p_CO.y() / p_CO.z(), start.v_px, 1e-3);
    least_px = std::min({least_px, start.u_px, 639.0 - start.u_px, start.v_px, 479.0 - start.v_px});
    const atlas::Start again = sampler.Draw(1, index);
    EXPECT_EQ(again.q, start.q);
    EXPECT_EQ(again.run_seed, start.run_seed);
    EXPECT_EQ(again.way_seed, start.way_seed);
    EXPECT_NE(sampler.Draw(2, index).q, start.q);
  }
  std::cout << "centre " << least_px << " px inside the picture, joints " << least_rad / kRadPerDeg
            << " deg inside their range, hand up to " << most_radius << " m from the base\n";
  EXPECT_GT(least_px, 30.0);
  EXPECT_GE(least_rad, 5.0 * kRadPerDeg);
  EXPECT_LE(most_radius, 0.848);
}
INSTANTIATE_TEST_SUITE_P(Targets, AtlasStarts, testing::Values("sphere", "circle", "square", "triangle"),
                         [](const auto& kind) { return std::string(kind.param); });

}  // namespace
}  // namespace fovea
