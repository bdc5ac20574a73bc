// SPDX-License-Identifier: Apache-2.0
// The program `fovea replay`, run from the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/host/recording/flight/recorded_run.hpp"
#include "tests/support/program.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class ReplayProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    RecordRun(TrackingRun("sphere", hal::FeatureKind::kSphere, features::FeatureForm::kSphere, 1300), log_);
  }
  ProgramResult Replay(std::vector<std::string> more) const {
    std::vector<std::string> all{FOVEA_PROGRAM, "replay", log_.string()};
    all.insert(all.end(), more.begin(), more.end());
    return RunProgram(all);
  }
  std::string Refusal(const std::vector<std::string>& more) const {
    const ProgramResult result = Replay(more);
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_EQ(result.out, "");
    return result.err;
  }

  const TempFolder folder_;
  const fs::path log_ = folder_.path() / "log.mcap";
};

TEST_F(ReplayProgramTest, ReportsAnIdenticalReplay) {
  const ProgramResult result = Replay({});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, log_.string() +
                            ": 1300 ticks replayed, recorded by another build of the servo\n"
                            "  segment 1       0.000 to 1.299 s, 1300 ticks, from the first tick: "
                            "bit-identical\n");
}

TEST_F(ReplayProgramTest, ReportsChangesUnderOtherSettings) {
  const std::string page = folder_.path() / "gain.html";
  const ProgramResult result =
      Replay({"--set", "servo.lambda=3", "--set", "servo.omega_n=30", "--json", "--out", page});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json replay = json::parse(result.out);
  std::vector<std::string> fields;
  for (const json& change : replay["changes"]) {
    fields.push_back(change["field"]);
    EXPECT_GT(change.value("most", 1.0), 0.0);  // flags have no "most"
    EXPECT_GT(change["first_s"], 0.0) << "the arm is not driven in the first tick";
  }
  EXPECT_THAT(fields, testing::Contains("dq_cmd[3]"));
  EXPECT_THAT(fields, testing::Contains("V_BC_C_cmd[0]"));
  EXPECT_THAT(fields, testing::Contains("command.tau[1]"));
  EXPECT_THAT(fields, testing::Not(testing::Contains("mode"))) << "the recorded arm states stay the same";
  std::ostringstream text;
  text << std::ifstream(page).rdbuf();
  EXPECT_THAT(text.str(), AllOf(HasSubstr("servo.lambda=3"), HasSubstr("servo.omega_n=30"),
                                HasSubstr("Replay with the changes")));
  // Setting a key to its recorded value changes nothing.
  const ProgramResult same = Replay({"--set", "servo.lambda=2", "--json", "--out", page});
  EXPECT_EQ(json::parse(same.out)["changes"].size(), 0U);
}

TEST_F(ReplayProgramTest, RefusesUnknownKeysOptionsAndFiles) {
  EXPECT_THAT(Refusal({"--set", "servo.lamda=3"}),
              HasSubstr("--set servo.lamda: a replay accepts the keys of [servo] and [safety]; did you mean "
                        "servo.lambda?"));
  EXPECT_THAT(Refusal({"--set", "camera.rate_hz=10"}), HasSubstr("accepts the keys of [servo] and [safety]"));
  EXPECT_THAT(Refusal({"--set", "servo.lambda=300"}), HasSubstr("expected a number, 0 to 20"));
  EXPECT_THAT(Refusal({"--out", "x.html"}), HasSubstr("--out needs --set"));
  EXPECT_THAT(Refusal({"--renew", "--from", "1"}), HasSubstr("--renew excludes --set and --from"));
  const ProgramResult none = RunProgram({FOVEA_PROGRAM, "replay", folder_.path() / "none.mcap"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("no such file"));
}

}  // namespace
}  // namespace fovea::test
