// SPDX-License-Identifier: Apache-2.0
// The program fovea on the command line: results and errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "tests/support/places.hpp"
#include "tests/support/program.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

class FoveaProgramTest : public testing::Test {
 protected:
  static test::ProgramResult Fovea(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FOVEA_PROGRAM);
    return test::RunProgram(arguments);
  }

  // Makes a run's folder with a short log.
  fs::path MakeRun(const std::string& name) const {
    const fs::path run = folder_.path() / name;
    fs::create_directories(run);
    log::RunLogConfig config;
    config.path = run / "log.mcap";
    config.library = "test";
    config.arm.num_joints = 1;
    log::RunLog log(config);
    log::Setup setup;
    setup.set_name(name);
    setup.add_joints()->set_name("only");
    log.Add(log::kSetupTopic, 0, setup);
    for (int i = 0; i < 100; ++i) {
      hal::TickRecord record;
      record.stamp_ns = i * hal::kTickPeriodNs;
      record.arm.num_joints = record.command.num_joints = 1;
      log.AddTick(record);
    }
    log.Finish();
    return run;
  }

  static void ExpectRefused(const test::ProgramResult& result, const std::string& says) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << "one line: " << result.err;
  }

  // `fovea gains` for the exercise, with `more` options.
  static test::ProgramResult Gains(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {
        "gains", "--mass", "16", "--damping", "16", "--stiffness", "4", "--closed-loop-stiffness", "16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Fovea(arguments);
  }

  const test::TempFolder folder_;
};

TEST_F(FoveaProgramTest, ReportIsWrittenBesideTheLog) {
  const fs::path run = MakeRun("swing");
  for (const fs::path& given : {run, run / "log.mcap"}) {
    fs::remove(run / "report.html");
    const test::ProgramResult result = Fovea({"report", given.string()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, (run / "report.html").string() + "\n");
    EXPECT_GT(fs::file_size(run / "report.html"), 1'000'000U) << "the page includes its libraries";
  }
}

TEST_F(FoveaProgramTest, ReportComparesTwoRuns) {
  const fs::path out = folder_.path() / "both.html";
  const test::ProgramResult result =
      Fovea({"report", MakeRun("one").string(), MakeRun("two").string(), "--out", out.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream stream(out);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(page.find("<title>one and two"), std::string::npos);
}

TEST_F(FoveaProgramTest, ReportRefusesAFileThatIsNoLog) {
  ExpectRefused(Fovea({"report", "nothing.mcap"}), "nothing.mcap: no such file");
  ExpectRefused(Fovea({"report", folder_.path().string()}), "log.mcap: no such file");
  const fs::path text = folder_.path() / "text.mcap";
  std::ofstream(text) << "words";
  ExpectRefused(Fovea({"report", text.string()}), "text.mcap: not an MCAP file");
}

TEST_F(FoveaProgramTest, ReportRefusesAnUnwritablePath) {
  const test::ProgramResult result =
      Fovea({"report", MakeRun("swing").string(), "--out", "/nowhere/report.html"});
  ExpectRefused(result, "/nowhere/report.html: cannot be written");
}

TEST_F(FoveaProgramTest, GainsOfTheExerciseMatchTheKnownValues) {
  const test::ProgramResult result = Gains();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* says : {"zeta 1, omega_n 0.5 rad/s", "-0.5, -0.5 1/s", "k_p 12 N/m, k_v 16 N s/m",
                           "zeta 1, omega_n 1 rad/s", "after 5.834 s", "0.99901136, 0.99898901",
                           "unstable from 2000 times both", "unstable from 1854.09 ms"}) {
    EXPECT_NE(result.out.find(says), std::string::npos) << says << " in\n" << result.out;
  }
}

TEST_F(FoveaProgramTest, GainsAsJsonHaveStableNames) {
  const test::ProgramResult result = Gains({"--delay-ms", "2.5", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  std::vector<std::string> names;
  for (const auto& item : json.items()) {
    names.push_back(item.key());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"closed_loop_stiffness",
                                             "closed_omega_n",
                                             "closed_poles",
                                             "closed_settle_time_s",
                                             "closed_zeta",
                                             "damping",
                                             "damping_ratio",
                                             "delay_edge_ms",
                                             "delay_ms",
                                             "delay_searched_to_ms",
                                             "discrete_poles",
                                             "discrete_poles_as_s",
                                             "gain_edge",
                                             "gain_searched_to",
                                             "k_p",
                                             "k_v",
                                             "mass",
                                             "notes",
                                             "open_omega_n",
                                             "open_poles",
                                             "open_zeta",
                                             "rate_hz",
                                             "spectral_radius",
                                             "stable",
                                             "stiffness"}));
  EXPECT_EQ(json["k_p"], 12.0);
  EXPECT_EQ(json["k_v"], 16.0);
  EXPECT_EQ(json["open_zeta"], 1.0);
  EXPECT_EQ(json["open_omega_n"], 0.5);
  EXPECT_EQ(json["closed_omega_n"], 1.0);
  EXPECT_EQ(json["stable"], true);
  EXPECT_EQ(json["delay_ms"], 2.5);
  EXPECT_NEAR(json["gain_edge"], 536.070924, 1e-5);
  EXPECT_NEAR(json["delay_edge_ms"], 1854.09043, 1e-4) << "the delay edge counts from zero delay";
  EXPECT_NEAR(json["closed_settle_time_s"], 5.8339217, 1e-7);
  EXPECT_EQ(json["discrete_poles"].size(), 5U);
  EXPECT_EQ(json["discrete_poles_as_s"][0].size(), 2U);
  EXPECT_TRUE(json["notes"].empty());
}

TEST_F(FoveaProgramTest, GainsReportUnstableNegativeAndUndampedLoops) {
  const test::ProgramResult unstable = Gains({"--delay-ms", "1900"});
  EXPECT_EQ(unstable.exit_code, 1) << "an unstable loop misses the goal";
  EXPECT_NE(unstable.out.find("UNSTABLE"), std::string::npos);
  EXPECT_NE(unstable.out.find("  stable from 0.9"), std::string::npos) << unstable.out;
  EXPECT_NE(unstable.out.find("poles are not listed"), std::string::npos);
  const test::ProgramResult soft = Fovea(
      {"gains", "--mass", "2", "--damping", "100", "--stiffness", "1000", "--closed-loop-stiffness", "800"});
  EXPECT_EQ(soft.exit_code, 0);
  EXPECT_NE(soft.out.find("k_v is negative"), std::string::npos) << soft.out;
  EXPECT_NE(soft.out.find("k_p is negative"), std::string::npos) << soft.out;
  const test::ProgramResult free = Fovea({"gains", "--mass", "2", "--damping", "0", "--stiffness", "0",
                                          "--closed-loop-stiffness", "800", "--json"});
  const nlohmann::json json = nlohmann::json::parse(free.out);
  EXPECT_TRUE(json["open_zeta"].is_null());
  EXPECT_EQ(json["open_omega_n"], 0.0);
  EXPECT_EQ(json["notes"].size(), 1U);
}

TEST_F(FoveaProgramTest, GainsNameTheWrongFlag) {
  ExpectRefused(Gains({"--damping-ratio", "0"}), "--damping-ratio 0: must be a number above 0");
  ExpectRefused(Gains({"--damping-ratio", "nan"}), "--damping-ratio: nan is not allowed");
  ExpectRefused(Gains({"--rate-hz", "inf"}), "--rate-hz: inf is not allowed");
  ExpectRefused(Gains({"--rate-hz", "-5"}), "--rate-hz -5: must be a number above 0");
  ExpectRefused(Gains({"--delay-ms", "-1"}), "--delay-ms -1: must be from 0 to 100000");
  ExpectRefused(Gains({"--delay-ms", "100001"}), "--delay-ms 100001: must be from 0 to 100000");
  const std::vector<std::string> names = {"--mass", "--damping", "--stiffness", "--closed-loop-stiffness"};
  for (const std::string& wrong : names) {
    std::vector<std::string> arguments = {"gains"};
    for (const std::string& name : names) {
      arguments.insert(arguments.end(), {name, name == wrong ? "-2" : "2"});
    }
    ExpectRefused(Fovea(arguments), wrong + " -2: must be");
  }
  ExpectRefused(Gains({"--rate-hz", "1e9"}),
                "--rate-hz 1000000000: must be from 1e-06 to 1e+06 for poles of 1 rad/s");
  ExpectRefused(Fovea({"gains", "--mass", "1e-300", "--damping", "1e300", "--stiffness", "4",
                       "--closed-loop-stiffness", "16"}),
                "--mass, --damping");
  const test::ProgramResult words = Gains({"--rate-hz", "fast"});
  EXPECT_EQ(words.exit_code, 2);
  EXPECT_NE(words.err.find("--rate-hz"), std::string::npos) << words.err;
  EXPECT_EQ(Fovea({"gains", "--mass", "2"}).exit_code, 2);
}

TEST_F(FoveaProgramTest, HelpShowsExamples) {
  EXPECT_NE(Fovea({"gains", "--help"}).out.find("  fovea gains --mass 16"), std::string::npos);
  const test::ProgramResult help = Fovea({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("fovea report out/ball"), std::string::npos);
  EXPECT_EQ(Fovea({"report"}).exit_code, 2);
  EXPECT_EQ(Fovea({}).exit_code, 2);
}

TEST_F(FoveaProgramTest, CalibrateFromLogNeedsTheServosConfiguration) {
  ExpectRefused(Fovea({"calibrate", "from-log", MakeRun("bare").string()}),
                "holds no run with a camera: its /servo/configuration is missing");
  const fs::path cut = MakeRun("cut") / "log.mcap";
  fs::resize_file(cut, fs::file_size(cut) / 2);
  ExpectRefused(Fovea({"calibrate", "from-log", cut.string()}), "cut off at byte");
}

// The table in the repository matches the program; renew it with `fovea guards`.
TEST_F(FoveaProgramTest, TableOfGuardsIsUpToDateAndComplete) {
  std::ifstream stream(test::SourceRoot() / "firmware/GUARDS.md");
  const std::string table{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_EQ(Fovea({"guards"}).out, table);
  EXPECT_EQ(table.find("|  |"), std::string::npos) << "the table has an empty cell";
  for (int i = 0; i < hal::kNumLimits; ++i) {
    EXPECT_NE(table.find(std::string("| `") + hal::Name(static_cast<hal::Limit>(i)) + "` |"),
              std::string::npos);
  }
  for (int i = 1; i < hal::kNumFaults; ++i) {
    EXPECT_NE(table.find(std::string("| `") + hal::Name(static_cast<hal::Fault>(i)) + "` |"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace fovea
