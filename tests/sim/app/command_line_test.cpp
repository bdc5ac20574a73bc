// SPDX-License-Identifier: Apache-2.0
// The fovea-sim command line: results, error messages and exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/sim/app/command_line.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST_F(CommandLineTest, BoardOptionWithoutABoardIsRefused) {
  const auto needs = [](const std::string& option, const std::string& choice) {
    return HasSubstr(option + " requires " + choice);
  };
  EXPECT_THAT(Refusal({"ball", "--servo-pace", "timer"}), needs("--servo-pace", "--servo mcu"));
  EXPECT_THAT(Refusal({"ball", "--servo", "pc", "--instruction-ns", "64"}),
              needs("--instruction-ns", "--servo mcu"));
  EXPECT_THAT(Refusal({"ball", "--servo-image", FOVEA_SIM_PROGRAM}), needs("--servo-image", "--servo mcu"));
  for (const char* option : {"--line-loss", "--line-delay-ms", "--line-jitter-ms", "--line-from-s"}) {
    EXPECT_THAT(Refusal({"ball", option, "1"}), needs(option, "--servo-pace timer"));
    EXPECT_THAT(Refusal({"ball", "--servo", "mcu", option, "1"}), needs(option, "--servo-pace timer"));
  }
  EXPECT_THAT(
      Refusal({"ball", "--servo", "mcu", "--servo-pace", "timer", "--set", "faults.deadline_miss_s=[1, 2]"}),
      AllOf(HasSubstr("faults.deadline_miss_s"), HasSubstr("--instruction-ns")));
}

// Without any frame the run writes no film and no camera pictures, but all other files.
TEST_F(CommandLineTest, RunWithoutAnyFrameFailsAndWritesNoFilm) {
  const ProgramResult result = Sim({"run", "ball", "--set", "faults.camera_outage_s=[0,100]", "--set",
                                    "run.duration_s=0.5", "--out", Out()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("the target was never found in view"));
  for (const char* file : {"report.html", "log.mcap", "summary.json", "bench.png"}) {
    EXPECT_TRUE(fs::exists(fs::path(Out()) / file)) << file;
  }
  for (const char* file : {"camera.mp4", "eye-first.png", "eye-last.png"}) {
    EXPECT_FALSE(fs::exists(fs::path(Out()) / file)) << file;
  }
}

TEST_F(CommandLineTest, UnknownScenarioIsRefusedWithASuggestion) {
  EXPECT_THAT(Refusal({"bal"}),
              AllOf(HasSubstr("unknown scenario \"bal\""), HasSubstr("did you mean ball?"),
                    HasSubstr("ball, ball-clutter, ball-dark, ball-eight, ball-exciting, "
                              "ball-jump, ball-line, ball-moving, ball-occluded, ball-puma560, "
                              "ball-pushed, ball-shutter, ball-uncertain, ball-ur5e, circle")));
  EXPECT_THAT(Refusal({"nowhere/to/be.toml"}), HasSubstr("nowhere/to/be.toml"));
}

TEST_F(CommandLineTest, UnknownKeyIsRefusedWithASuggestion) {
  EXPECT_THAT(Refusal({"ball", "--set", "servo.lamda=3"}),
              AllOf(HasSubstr("servo.lamda"), HasSubstr("servo.lambda")));
  const std::string file = Write("mine.toml", "[camera]\nrate_hz = 30\nspeed_hz = 3\n");
  EXPECT_THAT(Refusal({file}), AllOf(HasSubstr("mine.toml:3"), HasSubstr("camera.speed_hz")));
}

TEST_F(CommandLineTest, ValueOutOfRangeIsRefusedWithItsRange) {
  EXPECT_THAT(Refusal({"ball", "--set", "servo.lambda=-1"}),
              AllOf(HasSubstr("servo.lambda = -1"), HasSubstr("0 to 20 1/s")));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.lambda=nan"}), HasSubstr("0 to 20 1/s"));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.lambda=fast"}), HasSubstr("servo.lambda"));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.lambda"}), HasSubstr("key=value"));
  EXPECT_THAT(Refusal({"ball", "--set", "target.motion=\"hop\""}),
              AllOf(HasSubstr("\"still\""), HasSubstr("\"circle\"")));
  const std::string file = Write("mine.toml", "[camera]\nrate_hz = 30000\n");
  EXPECT_THAT(Refusal({file}), AllOf(HasSubstr("mine.toml:2"), HasSubstr("1 to 240 Hz")));
}

// Each value alone is allowed; the combination is not.
TEST_F(CommandLineTest, ContradictingValuesAreRefused) {
  EXPECT_THAT(Refusal({"ball", "--set", "arm.q_start=[0, 0, 0]"}),
              AllOf(HasSubstr("arm.q_start has 3 entries"), HasSubstr("has 7 joints")));
  EXPECT_THAT(Refusal({"ball", "--set", "arm.q_start=[0, 0, 0, 1, 0, 0, 0]"}),
              AllOf(HasSubstr("arm.q_start[3] = 1"), HasSubstr("joint 4 reaches from -3.0718 to -0.0698")));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.goal=[0, 0, 0.1]", "--set", "target.diameter=0.3"}),
              AllOf(HasSubstr("servo.goal = [0, 0, 0.1]"), HasSubstr("radius of 0.15 m")));
  EXPECT_THAT(Refusal({"home", "--set", "arm.load_mass=3", "--set", "arm.load_com=[0, 0, 1]"}),
              AllOf(HasSubstr("arm.load_mass"), HasSubstr("joint 6")));
  EXPECT_THAT(
      Refusal({"ball-puma560", "--set", "arm.load_mass=5", "--set", "arm.load_com=[0.29, 0.531, 0.182]"}),
      AllOf(HasSubstr("arm.load_com"), HasSubstr("at most 200 times")));
  EXPECT_THAT(Refusal({"flange-circle", "--set", "motion.normal=[0, 0, 0]"}), HasSubstr("motion.normal"));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.goal=[0.3, 0, 0.4]"}),
              AllOf(HasSubstr("servo.goal"), HasSubstr("outside the picture of 640 x 480 px")));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.goal=[0, 0, 1.3]"}),
              AllOf(HasSubstr("servo.goal"), HasSubstr("allow 0.12 to 1.2 m")));
  EXPECT_THAT(Refusal({"ball", "--set", "servo.stale_s=0.7"}),
              AllOf(HasSubstr("servo.stale_s = 0.7"), HasSubstr("servo.coast_s, which is 0.6 s")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.latency_ms=200"}),
              AllOf(HasSubstr("camera.latency_ms = 200"), HasSubstr("servo.stale_s = 0.15 s")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.row_time_us=80"}),
              AllOf(HasSubstr("camera.row_time_us = 80"), HasSubstr("38.4 ms"), HasSubstr("33.3 ms")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.row_time_us=60", "--set", "camera.latency_ms=10"}),
              AllOf(HasSubstr("camera.latency_ms = 10"), HasSubstr("16.9 ms")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.sub_exposures=65"}),
              AllOf(HasSubstr("camera.sub_exposures"), HasSubstr("64")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.bayer=RGGB"}),
              AllOf(HasSubstr("camera.bayer"), HasSubstr("BayerRG8")));
  EXPECT_THAT(Refusal({"ball", "--set", "truth.camera.row_time_us=80"}),
              AllOf(HasSubstr("truth.camera.row_time_us"), HasSubstr("69.4")));
  EXPECT_THAT(Refusal({"ball", "--set", "camera.exposure_ms=40"}),
              AllOf(HasSubstr("camera.exposure_ms = 40"), HasSubstr("33.3 ms")));
  EXPECT_THAT(Refusal({"ball", "--set", "faults.camera_outage_s=[3, 1]"}),
              HasSubstr("ends before it begins"));
  EXPECT_THAT(Refusal({"ball", "--set", "faults.load_s=[3, 1]"}),
              AllOf(HasSubstr("faults.load_s = [3, 1]"), HasSubstr("ends before it begins")));
  EXPECT_THAT(
      Refusal({"ball-ur5e", "--set", "faults.encoder_nan_s=[1, 2]", "--set", "faults.encoder_nan_joint=7"}),
      AllOf(HasSubstr("faults.encoder_nan_joint = 7"), HasSubstr("the arm has 6 joints")));
  EXPECT_THAT(Refusal({"ball", "--set", "faults.occluder_px=[1, 2, 0, 4]"}),
              HasSubstr("faults.occluder_px is not allowed: its size must be above 0 px"));
  EXPECT_THAT(Refusal({"ball", "--set", "safety.workspace_radius=0.7"}),
              AllOf(HasSubstr("arm.q_start"), HasSubstr("safety.workspace_radius = 0.7 m")));
}

TEST_F(CommandLineTest, BrokenTomlIsRefusedWithItsLine) {
  EXPECT_THAT(Refusal({Write("mine.toml", "[camera\nrate_hz = 30\n")}), HasSubstr("mine.toml:1"));
  EXPECT_THAT(Refusal({Write("mine.toml", "[[target]]\ndiameter = 0.1\n")}),
              AllOf(HasSubstr("mine.toml:1"), HasSubstr("write a section [name] once")));
}

TEST_F(CommandLineTest, BrokenUrdfIsRefused) {
  const std::string broken = Write("broken.urdf", "<robot name=\"b\"><link name=\"a\"/>");
  EXPECT_THAT(Refusal({"ball", "--set", "arm.model=\"" + broken + "\""}), HasSubstr("broken.urdf"));
  const std::string massless = Write(
      "massless.urdf",
      R"(<robot name="m"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>
         <child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)");
  EXPECT_THAT(Refusal({"ball", "--set", "arm.model=\"" + massless + "\""}),
              AllOf(HasSubstr("massless.urdf"), HasSubstr("inertia")));
  EXPECT_THAT(Refusal({"ball", "--set", "arm.model=\"gone.urdf\""}), HasSubstr("gone.urdf"));
  EXPECT_THAT(
      Refusal({"ball", "--set", "arm.model=\"pandaa\""}),
      HasSubstr(
          "arm.model: unknown arm \"pandaa\"; did you mean panda?; shipped are gantry, panda, puma560"));
}

TEST_F(CommandLineTest, UnwritableOutputFolderIsRefused) {
  const std::string file = Write("file", "something");
  const ProgramResult result =
      Sim({"run", "ball", "--set", "run.duration_s=0.1", "--no-report", "--out", file + "/out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("--out " + file + "/out"), HasSubstr("cannot be made")));
}

// The first run is stopped while the second one is tried, so that it is present at any speed.
TEST_F(CommandLineTest, SecondRunIntoTheSameFolderIsRefused) {
  const ProgramResult result = RunProgram(
      {"sh", "-c",
       R"("$0" run ball --set run.duration_s=0.3 --seed 1 --json --out "$1" > /dev/null 2>&1 & first=$!
until [ -e "$1/.log.mcap.partial" ]; do kill -0 $first || exit 9; sleep 0.02; done
kill -STOP $first
"$0" run ball --set run.duration_s=0.3 --seed 2 --no-report --out "$1"; second=$?
kill -CONT $first; wait $first
echo "first $? second $second")",
       FOVEA_SIM_PROGRAM, Out()});
  EXPECT_EQ(result.out, "first 1 second 2\n") << "0.3 s are too short to converge";
  EXPECT_THAT(result.err, HasSubstr("fovea-sim: --out " + Out() + ": another run writes there"));
  std::ifstream summary(Out() + "/summary.json");
  EXPECT_EQ(nlohmann::json::parse(summary)["seed"], 1);
  for (const char* file : {"report.html", "log.mcap", "camera.mp4", "eye-last.png"}) {
    EXPECT_TRUE(fs::exists(fs::path(Out()) / file)) << file;
  }
}

TEST_F(CommandLineTest, MissingEglIsRefusedWithAHint) {
  // Detected while the run is prepared, so a progress line comes before the error.
  const ProgramResult result =
      Sim({"run", "ball", "--out", Out()}, {"__EGL_VENDOR_LIBRARY_DIRS=/nonexistent"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_FALSE(fs::exists(Out())) << "files were left behind";
  EXPECT_THAT(result.err, AllOf(HasSubstr("EGL"), HasSubstr("libgl1-mesa-dri")));
}

TEST_F(CommandLineTest, LostProgressIsToleratedAndALostResultFails) {
  const auto shell = [&](const std::string& redirection) {
    return RunProgram({"sh", "-c",
                       std::string("\"$0\" run ball --set run.duration_s=0.1 --no-report --out \"$1\" ") +
                           redirection,
                       FOVEA_SIM_PROGRAM, Out()})
        .exit_code;
  };
  EXPECT_EQ(shell("2>/dev/full"), 1) << "lost progress lines do not fail the run";
  EXPECT_EQ(shell("2>&-"), 1);
  EXPECT_EQ(shell(">/dev/full"), 2) << "a lost result fails the run";
}

TEST_F(CommandLineTest, ScenarioNameWithInvalidBytesGivesValidJson) {
  const std::string file = Write("b\xFF ll.toml", "[run]\nduration_s = 0.1\n");
  const ProgramResult result = Sim({"run", file, "--json", "--no-report", "--out", Out()});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_TRUE(nlohmann::json::accept(result.out));
}

TEST_F(CommandLineTest, WrongUsageExitsWith2) {
  EXPECT_EQ(Sim({}).exit_code, 2);
  EXPECT_EQ(Sim({"fly"}).exit_code, 2);
  EXPECT_EQ(Sim({"run"}).exit_code, 2);
  const ProgramResult pace = Sim({"run", "ball", "--pace", "slow"});
  EXPECT_EQ(pace.exit_code, 2);
  EXPECT_THAT(pace.err, AllOf(HasSubstr("--pace"), HasSubstr("lockstep"), HasSubstr("real")));
  EXPECT_EQ(Sim({"run", "ball", "--seed", "-3"}).exit_code, 2);
}

TEST_F(CommandLineTest, HelpShowsExamplesAndExitCodes) {
  const ProgramResult help = Sim({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("Examples:"), HasSubstr("fovea-sim run ball"), HasSubstr("Exit: 0")));
  EXPECT_THAT(Sim({"run", "--help"}).out, AllOf(HasSubstr("--set"), HasSubstr("--pace"), HasSubstr("--out")));
  EXPECT_THAT(Sim({"--version"}).out, testing::StartsWith("fovea-sim 0."));
}

TEST_F(CommandLineTest, ListAndKeysShowScenariosAndKeys) {
  const std::string list = Sim({"list"}).out;
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), 28) << "a pipe gets one line for each scenario";
  EXPECT_THAT(list, AllOf(HasSubstr("ball "), HasSubstr("ball-moving "), HasSubstr("ball-dark "),
                          HasSubstr("ball-clutter "), HasSubstr("circle "), HasSubstr("flange-circle "),
                          HasSubstr("theory/open-loop ")));
  EXPECT_THAT(Sim({"keys"}).out,
              HasSubstr("servo.lambda = 2\n    gain: the error decays like exp(-lambda t); "
                        "may change in motion; a number: 0 to 20 1/s\n"));
}

TEST_F(CommandLineTest, KeysHaveTheValuesOfAScenario) {
  const ProgramResult result = Sim({"keys", "--values", "square", "--set", "camera.hfov_deg=70"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("\"camera.hfov_deg\": \"70\""), HasSubstr("\"target.kind\": "),
                                HasSubstr("\"servo.goal\": \"[0, 0, 0.4]\"")));
  EXPECT_EQ(Sim({"keys", "--values", "squar"}).exit_code, 2);
  EXPECT_EQ(Sim({"keys", "--set", "camera.hfov_deg=70"}).exit_code, 2);
}

// The table in the repository matches the program; renew it with `fovea-sim keys --markdown`.
TEST_F(CommandLineTest, TableOfKeysIsUpToDate) {
  std::ostringstream table;
  table << std::ifstream(test::SourceRoot() / "sim/scenarios/KEYS.md").rdbuf();
  EXPECT_EQ(Sim({"keys", "--markdown"}).out, table.str());
}

// A run too short to converge: exit code 1, and complete files.
TEST_F(CommandLineTest, RunThatMissesItsGoalExitsWith1AndWritesItsFiles) {
  const ProgramResult result = Sim(
      {"run", "ball", "--set", "run.duration_s=0.3", "--seed", "9", "--json", "--no-report", "--out", Out()});
  EXPECT_EQ(result.exit_code, 1);
  const auto json = nlohmann::json::parse(result.out);
  std::ifstream file(Out() + "/summary.json");
  EXPECT_EQ(json, nlohmann::json::parse(file)) << "printed and written summary are equal";
  for (const char* key : {"scenario",
                          "seed",
                          "converged",
                          "settle_time_s",
                          "final_error_px_rms",
                          "final_error_mm",
                          "final_error_lateral_mm",
                          "final_error_depth_mm",
                          "final_error_deg",
                          "error_px_max",
                          "camera_path_m",
                          "camera_excursion_m",
                          "tracking_error_px_rms",
                          "limits",
                          "limit_violations",
                          "faults",
                          "frames",
                          "frames_detected",
                          "ticks",
                          "overruns",
                          "heap_allocations_in_tick",
                          "page_faults_in_loop",
                          "tick_ns",
                          "sim_time_s",
                          "wall_time_s",
                          "real_time_factor",
                          "log_hash",
                          "servo",
                          "git"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"p50", "p99", "p999", "max"}) {
    EXPECT_TRUE(json["tick_ns"].contains(key)) << key;
  }
  EXPECT_EQ(json["scenario"], "ball");
  EXPECT_EQ(json["seed"], 9);
  EXPECT_EQ(json["converged"], false);
  EXPECT_EQ(json["ticks"], 300);
  EXPECT_EQ(json["log_hash"].get<std::string>().size(), 64U);
  EXPECT_THAT(json["verdict"].get<std::string>(), HasSubstr("not converged"));
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(Out())) {
    names.push_back(entry.path().filename());
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("summary.json", "eye-first.png", "eye-last.png",
                                                   "frame-last.png"));
}

TEST_F(CommandLineTest, RefusedRunKeepsTheFilesOfTheLastOne) {
  ASSERT_EQ(Sim({"run", "ball", "--set", "run.duration_s=0.1", "--no-report", "--out", Out()}).exit_code, 1);
  const auto written = fs::last_write_time(Out() + "/summary.json");
  EXPECT_EQ(Sim({"run", "ball", "--set", "servo.lambda=-1", "--out", Out()}).exit_code, 2);
  EXPECT_EQ(fs::last_write_time(Out() + "/summary.json"), written);
}

// The run is the same on one core and on two, and in any process.
TEST_F(CommandLineTest, SameSeedGivesTheSameRunOnOneCore) {
  const auto hash = [&](std::vector<std::string> before, const std::string& seed) {
    before.insert(before.end(), {FOVEA_SIM_PROGRAM, "run", "ball", "--set", "run.duration_s=1.5", "--seed",
                                 seed, "--json", "--no-report", "--out", Out()});
    const ProgramResult result = RunProgram(before);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    return nlohmann::json::parse(result.out)["log_hash"].get<std::string>();
  };
  const std::string first = hash({}, "1");
  EXPECT_EQ(hash({}, "1"), first);
  EXPECT_EQ(hash({"taskset", "-c", "0"}, "1"), first);
  EXPECT_NE(hash({}, "2"), first);
}

}  // namespace
}  // namespace fovea::test
