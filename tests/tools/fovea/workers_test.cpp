// SPDX-License-Identifier: Apache-2.0
// Simulator processes that do run after run: a crash or a run without end costs that run only.
#include "tools/fovea/atlas/workers.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "tests/support/temp_folder.hpp"

namespace fovea::atlas {
namespace {

using std::chrono::seconds;

class WorkersTest : public testing::Test {
 protected:
  // A program in the simulator's place: answers each request by `answer`, a line of shell that knows its
  // $line.
  Workers Make(const std::string& answer) {
    const std::filesystem::path program = folder_.path() / "simulator";
    std::ofstream(program) << "#!/bin/sh\nwhile read -r line; do\n" << answer << "\ndone\n";
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return Workers(program);
  }
  void Start(Workers& workers, int tag, const std::string& word, seconds limit = seconds(60)) {
    workers.Start(tag, {word}, folder_.path() / "out", folder_.path() / "err", limit);
  }

  test::TempFolder folder_;
};

TEST_F(WorkersTest, AProcessDoesRunAfterRunAndSoManyRunAtOnceAsWereStarted) {
  Workers workers = Make("echo $$ >> " + (folder_.path() / "pids").string() + "; echo 0");
  for (int round = 0; round < 3; ++round) {
    Start(workers, 1, "a");
    Start(workers, 2, "b");
    EXPECT_EQ(workers.running(), 2U);
    std::map<int, int> codes;
    for (int i = 0; i < 2; ++i) {
      const Workers::Ended ended = workers.WaitForOne();
      codes[ended.tag] = ended.exit_code;
    }
    EXPECT_EQ(codes, (std::map<int, int>{{1, 0}, {2, 0}}));
    EXPECT_EQ(workers.running(), 0U);
  }
  std::ifstream stream(folder_.path() / "pids");
  std::map<std::string, int> runs;
  for (std::string pid; stream >> pid;) {
    ++runs[pid];
  }
  EXPECT_EQ(runs.size(), 2U) << "processes";
}

TEST_F(WorkersTest, ACrashCostsOneRun) {
  Workers workers = Make("case $line in *crash*) kill -SEGV $$ ;; *quit*) exit 3 ;; *) echo 1 ;; esac");
  for (const auto& [word, code] : {std::pair{"a", 1}, {"crash", -1}, {"b", 1}, {"quit", 3}, {"c", 1}}) {
    Start(workers, 7, word);
    const Workers::Ended ended = workers.WaitForOne();
    EXPECT_EQ(ended.tag, 7);
    EXPECT_EQ(ended.exit_code, code) << word;
  }
}

TEST_F(WorkersTest, ARunBeyondItsLimitIsKilled) {
  Workers workers = Make("case $line in *sleep*) exec sleep 60 ;; *) echo 0 ;; esac");
  Start(workers, 1, "sleep", seconds(1));
  EXPECT_EQ(workers.WaitForOne().exit_code, -1);
  Start(workers, 2, "b");
  EXPECT_EQ(workers.WaitForOne().exit_code, 0);
}

TEST_F(WorkersTest, AProgramThatIsNotThereIsAnExitCode) {
  Workers workers(folder_.path() / "nothing");
  Start(workers, 1, "a");
  EXPECT_EQ(workers.WaitForOne().exit_code, 127);
}

}  // namespace
}  // namespace fovea::atlas
