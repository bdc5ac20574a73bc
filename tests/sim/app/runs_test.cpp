// SPDX-License-Identifier: Apache-2.0
// `fovea-sim runs`: many runs in one process have the results of single runs, whatever ran before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/sim/app/command_line.hpp"

namespace fovea::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class RunsTest : public CommandLineTest {
 protected:
  // The words of a run that is as short as possible.
  std::vector<std::string> Words(const std::string& scenario, int number,
                                 const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{scenario, "--no-report", "--json", "--set", "run.duration_s=0.4"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--out", File(number, "")});
    return words;
  }
  std::string File(int number, const std::string& ending) {
    return folder_.path() / ("run" + std::to_string(number) + ending);
  }
  std::string Request(const std::vector<std::string>& words, int number) {
    return json{{"run", words}, {"out", File(number, ".json")}, {"err", File(number, ".txt")}}.dump() + "\n";
  }
  // With `requests` on standard input.
  ProgramResult Runs(const std::string& requests) {
    const std::string file = Write("requests.jsonl", requests);
    return RunProgram({"sh", "-c", R"(exec "$0" runs < "$1")", FOVEA_SIM_PROGRAM, file});
  }
  static std::string Content(const std::string& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // Without what depends on the computer's speed, and on the folder.
  static json Summary(const std::string& text) {
    json summary = json::parse(text);
    for (const char* key :
         {"wall_time_s", "preparing_s", "writing_s", "real_time_factor", "page_faults_in_loop", "tick_ns"}) {
      summary.erase(key);
    }
    return summary;
  }
};

TEST_F(RunsTest, EachRunHasTheResultOfASingleOne) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> runs{
      {"square", {"--seed", "3"}},
      {"ball", {"--seed", "4"}},
      {"square", {"--seed", "3"}},
      {"square", {"--seed", "3", "--set", "target.side=0.1", "--set", "camera.light=0.7"}},
      {"square-boxes", {"--seed", "5"}},
      {"ball", {"--seed", "4", "--set", "camera.row_time_us=30", "--set", "camera.sub_exposures=2"}},
      {"square", {"--seed", "3", "--set", "camera.mount_xyz=[0.06,0.01,0.05]"}}};
  std::string requests;
  for (int i = 0; i < static_cast<int>(runs.size()); ++i) {
    const auto& [scenario, more] = runs[static_cast<std::size_t>(i)];
    requests += Request(Words(scenario, i, more), i);
  }
  const ProgramResult result = Runs(requests);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "1\n1\n1\n1\n1\n1\n1\n") << "none has the time to converge";
  for (int i = 0; i < static_cast<int>(runs.size()); ++i) {
    const auto& [scenario, more] = runs[static_cast<std::size_t>(i)];
    std::vector<std::string> words = Words(scenario, i, more);
    words.insert(words.begin(), "run");
    const ProgramResult single = Sim(words);
    EXPECT_EQ(Summary(single.out), Summary(Content(File(i, ".json")))) << i << ": " << scenario;
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(File(i, "")) / "eye-last.png"));
  }
}

TEST_F(RunsTest, ARefusedRunIsAnsweredAndTheNextOneRuns) {
  const ProgramResult result = Runs(
      Request(Words("ball", 0, {"--set", "servo.lambda=-1"}), 0) + Request(Words("ball", 1, {"--live"}), 1) +
      Request(Words("ball", 2, {"--sed", "1"}), 2) + Request(Words("ball", 3), 3));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "2\n2\n2\n1\n");
  EXPECT_THAT(Content(File(0, ".txt")), HasSubstr("servo.lambda"));
  EXPECT_THAT(Content(File(1, ".txt")), HasSubstr("--live is not allowed here"));
  EXPECT_THAT(Content(File(2, ".txt")), HasSubstr("--sed"));
  EXPECT_EQ(Content(File(0, ".json")), "");
}

TEST_F(RunsTest, WrongRequestsEndTheProgramWithTheirLine) {
  for (const std::string request :
       {"ball", "{}", R"({"run": "ball", "out": "a", "err": "b"})", R"({"run": ["ball"], "out": "a"})"}) {
    const ProgramResult result = Runs(Request(Words("ball", 0, {"--help"}), 0) + request + "\n");
    EXPECT_EQ(result.exit_code, 2) << request;
    EXPECT_EQ(result.out, "0\n");
    EXPECT_THAT(result.err, HasSubstr("standard input, line 2: expected {\"run\": [\"ball\", ...]"));
  }
  const ProgramResult result = Runs(R"({"run": ["ball"], "out": "/nowhere/a", "err": "/nowhere/b"})"
                                    "\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("/nowhere/a: cannot be written"));
}

}  // namespace
}  // namespace fovea::test
