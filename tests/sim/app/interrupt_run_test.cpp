// SPDX-License-Identifier: Apache-2.0
// Ctrl-C at any moment of a run leaves readable files. (Each test waits
// for the run to reach a state before it sends the signal.)
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "firmware/host/recording/log/mcap_reader.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;

// Starts a run; `script` sends it signals. Returns how it ended.
class InterruptTest : public testing::Test {
 protected:
  // `before`: what the script does first.
  ProgramResult Interrupt(const std::string& script, const std::string& settings = "",
                          const std::string& before = "") {
    return RunProgram({"sh", "-c",
                       before + R"(
"$0" run ball --json --out "$1" )" +
                           settings +
                           R"( > "$1.json" 2> "$1.err" & run=$!
)" + script + R"(
wait $run; echo "ended with $?")",
                       FOVEA_SIM_PROGRAM, Out()});
  }
  nlohmann::json Summary() {
    std::ifstream file(Out() + "/summary.json");
    return nlohmann::json::parse(file);
  }
  std::string Out() { return folder_.path() / "out"; }
  // The number of ticks in the log, and whether the log is complete.
  std::pair<int, bool> TicksInLog() {
    int ticks = 0;
    log::McapVisitor visitor;
    visitor.on_message = [&](const log::McapMessage& message) {
      ticks += message.topic == log::kTickTopic ? 1 : 0;
    };
    const log::McapEnd end = log::ReadMcap(Out() + "/log.mcap", visitor);
    return {ticks, end.complete};
  }
  std::string Err() {
    std::ostringstream text;
    text << std::ifstream(Out() + ".err").rdbuf();
    return text.str();
  }

  TempFolder folder_;
};

constexpr const char* kUntilItRuns =
    R"(until [ -s "$1/.log.mcap.partial" ]; do kill -0 $run || exit 9; sleep 0.02; done)";

// Ctrl-C, and a closed terminal.
class InterruptBy : public InterruptTest, public testing::WithParamInterface<const char*> {};

TEST_P(InterruptBy, InterruptedRunLeavesReadableLogAndSummary) {
  const ProgramResult result =
      Interrupt(std::string(kUntilItRuns) + "\nkill -" + GetParam() + " $run", "--set run.duration_s=600");
  EXPECT_EQ(result.out, "ended with 1\n") << Err();
  const nlohmann::json summary = Summary();
  EXPECT_TRUE(summary["interrupted"]);
  EXPECT_FALSE(summary["converged"]);
  EXPECT_THAT(summary["verdict"].get<std::string>(), testing::HasSubstr("interrupted after"));
  EXPECT_LT(summary["sim_time_s"], 600.0);
  const auto [ticks, whole] = TicksInLog();
  EXPECT_TRUE(whole);
  EXPECT_EQ(ticks, summary["ticks"]);
  EXPECT_TRUE(fs::exists(fs::path(Out()) / "report.html"));
}
INSTANTIATE_TEST_SUITE_P(Signals, InterruptBy, testing::Values("INT", "HUP"),
                         [](const auto& name) { return std::string(name.param); });

TEST_F(InterruptTest, InterruptEndsARunThatMissesAllItsTicks) {
  const ProgramResult result =
      Interrupt(std::string(kUntilItRuns) + "\nsleep 3; kill -INT $run",
                "--set run.duration_s=600 --set 'faults.deadline_miss_s=[0.05, 1e6]'");
  EXPECT_EQ(result.out, "ended with 1\n") << Err();
  EXPECT_TRUE(Summary()["interrupted"]);
  EXPECT_EQ(Summary()["ticks"], 50);
  EXPECT_LT(Summary()["sim_time_s"], 600.0);
  EXPECT_TRUE(TicksInLog().second);
}

// Before the folder exists: the run ends with its first tick.
TEST_F(InterruptTest, InterruptWhilePreparingLeavesLogAndSummary) {
  const ProgramResult result = Interrupt(
      R"(until grep -q 'SigBlk:.*[2367abef]$' /proc/$run/status; do kill -0 $run || exit 9; done
kill -INT $run)");
  EXPECT_EQ(result.out, "ended with 1\n") << Err();
  const nlohmann::json summary = Summary();
  EXPECT_TRUE(summary["interrupted"]);
  EXPECT_GE(summary["ticks"], 1);
  const auto [ticks, whole] = TicksInLog();
  EXPECT_TRUE(whole);
  EXPECT_EQ(ticks, summary["ticks"]);
}

// While films and report are written, the run itself is over and is judged as usual.
TEST_F(InterruptTest, InterruptWhileWritingFilesKeepsTheResult) {
  const ProgramResult result = Interrupt(
      R"(until [ -s "$1/.summary.json.partial" ] || grep -q drawing "$1.err"; do kill -0 $run || exit 9; done
kill -INT $run)",
      "--set run.duration_s=0.3");
  EXPECT_EQ(result.out, "ended with 1\n") << Err();
  const nlohmann::json summary = Summary();
  EXPECT_FALSE(summary["interrupted"]);
  EXPECT_EQ(summary["ticks"], 300);
  EXPECT_EQ(TicksInLog(), std::pair(300, true));
}

// Nobody reads standard error, whose pipe is full from the start.
TEST_F(InterruptTest, FullPipeOfStandardErrorDelaysNeitherRunNorEnd) {
  const ProgramResult result = Interrupt(std::string(kUntilItRuns) + "\nkill -INT $run",
                                         "--set run.duration_s=600", R"(mkfifo "$1.err"; exec 3<> "$1.err"
for size in 4096 1; do dd if=/dev/zero of="$1.err" bs=$size count=1000000 oflag=nonblock 2> /dev/null; done)");
  EXPECT_EQ(result.out, "ended with 1\n");
  EXPECT_TRUE(Summary()["interrupted"]);
  EXPECT_TRUE(TicksInLog().second);
}

TEST_F(InterruptTest, ClosedPipeOfStandardErrorDoesNotEndTheRun) {
  const ProgramResult result = RunProgram({"sh", "-c", R"(mkfifo "$1.err"; exec 3<> "$1.err" 4> "$1.err" 3>&-
"$0" run ball --json --out "$1" --set run.duration_s=0.3 > "$1.json" 2>&4 4>&- & run=$!
exec 4>&-
wait $run; echo "ended with $?")",
                                           FOVEA_SIM_PROGRAM, Out()});
  EXPECT_EQ(result.out, "ended with 1\n");
  EXPECT_EQ(Summary()["ticks"], 300);
  EXPECT_EQ(TicksInLog(), std::pair(300, true));
}

TEST_F(InterruptTest, ServedRobotPrintsItsResultWhenTheFolderCannotBeWritten) {
  fs::create_directories(fs::path(Out()) / "summary.json");
  const ProgramResult result = RunProgram(
      {"sh", "-c", R"("$0" serve ball --fci-port 0 --camera-serial "" --json --out "$1" 2> "$1.err" & run=$!
until grep -q serving "$1.err"; do kill -0 $run || exit 9; sleep 0.02; done
kill -TERM $run; wait $run; exit $?)",
       FOVEA_SIM_PROGRAM, Out()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(nlohmann::json::parse(result.out)["scenario"], "ball");
  EXPECT_THAT(Err(), testing::HasSubstr("summary.json: cannot be written: a folder has that name"));
}

// A second signal ends the run at once; only the log remains, up to there.
TEST_F(InterruptTest, SecondInterruptEndsAtOnceAndKeepsTheLog) {
  const std::string before = "of a run before";
  fs::create_directories(Out());
  std::ofstream(Out() + "/summary.json") << before;
  const ProgramResult result = Interrupt(std::string(kUntilItRuns) + R"(
until [ $(stat -c %s "$1/.log.mcap.partial") -gt 400000 ]; do kill -0 $run || exit 9; sleep 0.02; done
kill -STOP $run; kill -INT $run; kill -TERM $run; kill -CONT $run)",
                                         "--set run.duration_s=600");
  EXPECT_EQ(result.out, "ended with 143\n") << Err();
  const auto [ticks, whole] = TicksInLog();
  EXPECT_FALSE(whole);
  EXPECT_GT(ticks, 100);
  EXPECT_FALSE(fs::exists(Out() + "/summary.json")) << "no summary of an earlier run remains";
}

}  // namespace
}  // namespace fovea::test
