// SPDX-License-Identifier: Apache-2.0
// Logs of whole runs: each kind is replayed bit-exactly, and a run that
// is killed, or whose disk is full, leaves a readable log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "firmware/host/recording/flight/log_ticks.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class FlightLogTest : public testing::Test {
 protected:
  std::vector<std::string> RunOf(std::vector<std::string> arguments) const {
    std::vector<std::string> all{FOVEA_SIM_PROGRAM, "run"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--out", out_.string(), "--json"});
    return all;
  }
  json Replayed(std::vector<std::string> more = {}, int exit_code = 0) const {
    std::vector<std::string> all{FOVEA_PROGRAM, "replay", out_.string(), "--json"};
    all.insert(all.end(), more.begin(), more.end());
    const ProgramResult replay = RunProgram(all);
    EXPECT_EQ(replay.exit_code, exit_code) << replay.out << replay.err;
    return json::parse(replay.out);
  }
  void ExpectIdentical(const std::vector<std::string>& arguments) const {
    const ProgramResult run = RunProgram(RunOf(arguments));
    ASSERT_NE(run.exit_code, 2) << run.err;
    const json summary = json::parse(run.out);
    const json replay = Replayed();
    EXPECT_TRUE(replay["identical"]) << arguments[0] << ": " << replay["segments"];
    EXPECT_TRUE(replay["complete"]);
    EXPECT_TRUE(replay["same_build"]);
    const std::uint64_t lost = replay["ticks_lost"];
    if (lost == 0) {
      EXPECT_EQ(replay["ticks"], summary["ticks"]) << arguments[0];
      EXPECT_EQ(replay["segments"].size(), 1U);
    } else {  // only at real pace, on a machine too busy to write
      const std::uint64_t records = summary["records_dropped"];
      const std::uint64_t entries = summary["log_entries_dropped"];
      EXPECT_LE(lost, records + entries);
    }
    std::cout << arguments[0] << ": " << replay["ticks"] << " of " << summary["ticks"] << " ticks\n";
  }
  // The number of ticks in the log, which may still be written.
  std::size_t TicksIn(const fs::path& log) const {
    std::size_t ticks = 0;
    flight::TickVisitor visitor;
    visitor.on_tick = [&ticks](const log::Tick&, const hal::FeatureMeasurement&) { ++ticks; };
    flight::ReadTicks(log, visitor);
    return ticks;
  }

  const TempFolder folder_;
  const fs::path out_ = folder_.path() / "out";
};

TEST_F(FlightLogTest, LockstepRunReplaysBitExact) {
  const std::string brief = "run.duration_s=1.6";
  ExpectIdentical({"ball", "--set", brief});
  ExpectIdentical({"ball", "--set", brief, "--set", "faults.packet_loss_s=[0.2, 1]", "--set",
                   "faults.packet_loss=0.1", "--set", "faults.deadline_miss_s=[0.2, 1]", "--set",
                   "faults.deadline_miss=0.05", "--set", "faults.encoder_nan_s=[1.1, 1.103]", "--set",
                   "faults.frame_loss_s=[0.2, 1]", "--set", "faults.frame_loss=0.3"});
  ExpectIdentical({"ball", "--set", brief, "--set", "faults.encoder_nan_s=[1, 2]"});
  ExpectIdentical({"triangle", "--set", brief});
  ExpectIdentical({"square", "--set", brief});
  ExpectIdentical({"circle", "--set", brief});
  ExpectIdentical({"ball-ur5e", "--set", brief});
  ExpectIdentical({"home", "--set", brief});
  ExpectIdentical({"flange-circle", "--set", brief});
  ExpectIdentical({"theory/trajectory-friction", "--set", brief});
}

// A log names the keys that it was recorded with, for any scenario: setting them to the recorded values
// changes nothing, and another value does.
TEST_F(FlightLogTest, ReplayWithTheRecordedSettingsHasNoChanges) {
  for (const char* scenario : {"ball", "square", "home"}) {
    ASSERT_NE(RunProgram(RunOf({scenario, "--set", "run.duration_s=0.6", "--set", "servo.omega_n=23.456789",
                                "--set", "safety.workspace_radius=0.8512345"}))
                  .exit_code,
              2);
    const std::string page = folder_.path() / "page.html";
    EXPECT_EQ(Replayed({"--set", "servo.omega_n=23.456789", "--out", page})["changes"].size(), 0U)
        << scenario;
    EXPECT_GT(Replayed({"--set", "servo.omega_n=30", "--out", page})["changes"].size(), 0U) << scenario;
  }
}

TEST_F(FlightLogTest, RealPaceRunReplaysBitExact) {
  ExpectIdentical({"ball", "--pace", "real", "--set", "run.duration_s=3"});
}

// Killed by SIGKILL while it writes: all that was in the file before is replayed, and the report shows it.
TEST_F(FlightLogTest, KilledRunReplaysUpToTheKill) {
  std::vector<std::string> arguments = RunOf({"ball", "--pace", "real", "--set", "run.duration_s=600"});
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  pid_t pid = 0;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0600);
  ASSERT_EQ(posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  const fs::path partial = out_ / ".log.mcap.partial";
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  std::size_t seen = 0;
  while (seen < 1500 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    seen = fs::exists(partial) && fs::file_size(partial) > 100 ? TicksIn(partial) : 0;
  }
  kill(pid, SIGKILL);
  int status = 0;
  waitpid(pid, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_GE(seen, 1500U);
  const json replay = Replayed();
  EXPECT_THAT(replay["log"].get<std::string>(), HasSubstr(".log.mcap.partial"));
  EXPECT_TRUE(replay["identical"]) << replay["segments"];
  EXPECT_FALSE(replay["complete"]);
  const std::uint64_t lost = replay["ticks_lost"];
  EXPECT_GE(TicksIn(partial) + lost, seen);
  std::cout << "seen " << seen << " ticks, replayed " << replay["ticks"] << '\n';

  const ProgramResult report = RunProgram({FOVEA_PROGRAM, "report", out_.string()});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(report.err, HasSubstr("cut off at byte"));
}

// A full disk blocks nothing: the run goes on to its end, reports the error and keeps the log.
TEST_F(FlightLogTest, FullDiskKeepsTheLogUpToThere) {
  fs::create_directories(out_);
  std::vector<std::string> arguments = RunOf({"ball", "--set", "run.duration_s=4"});
  std::vector<std::string> all{"sh", "-c", "trap '' XFSZ; ulimit -f 8192; exec \"$@\"", "sh"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const ProgramResult run = RunProgram(all);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("cannot be written"));
  EXPECT_THAT(run.err, HasSubstr("the incomplete log is kept in " + (out_ / "log.mcap").string()));
  EXPECT_EQ(std::distance(fs::directory_iterator(out_), fs::directory_iterator()), 1);
  const json replay = Replayed();
  EXPECT_TRUE(replay["identical"]);
  EXPECT_FALSE(replay["complete"]);
  EXPECT_GT(replay["ticks"], 500);
  EXPECT_EQ(json::parse(run.out)["ticks"], 4000) << "the result is printed";
  std::cout << "replayed " << replay["ticks"] << " of 4000 ticks\n";
}

// A file that cannot be written costs neither the result nor the log.
TEST_F(FlightLogTest, UnwritableReportKeepsResultAndLog) {
  fs::create_directories(out_ / "report.html");
  const ProgramResult run = RunProgram(RunOf({"ball", "--set", "run.duration_s=0.3"}));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err,
              HasSubstr("a folder has that name; the log is kept in " + (out_ / "log.mcap").string()));
  EXPECT_EQ(json::parse(run.out)["ticks"], 300);
  EXPECT_TRUE(Replayed()["complete"]);
  EXPECT_TRUE(fs::is_directory(out_ / "report.html")) << "it is not the run's";
}

TEST_F(FlightLogTest, UnwritableTraceKeepsResultAndFiles) {
  const ProgramResult run =
      RunProgram(RunOf({"ball", "--set", "run.duration_s=0.3", "--trace", "/dev/full"}));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("/dev/full"));
  EXPECT_EQ(json::parse(run.out)["ticks"], 300);
  EXPECT_TRUE(fs::exists(out_ / "summary.json"));
  EXPECT_TRUE(fs::exists(out_ / "report.html"));
}

}  // namespace
}  // namespace fovea::test
