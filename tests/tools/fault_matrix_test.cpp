// `fovea atlas --faults`: real cells of the matrix, as the page in sim/FAULTS.md has them; refusals in one
// line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/places.hpp"
#include "support/program.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

std::string Content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class FaultMatrixTest : public testing::Test {
 protected:
  test::ProgramResult Faults(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{FOVEA_PROGRAM, "atlas", "--faults", "--out", folder_.path() / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram(arguments, {}, std::chrono::seconds(300));
  }
  const test::TempFolder folder_;
};

// An arm that is silent for 0.1 s, at each stage of its way home. The page's row is what it says today; renew
// the page with `fovea atlas --faults --markdown` where the servo was meant to change.
TEST_F(FaultMatrixTest, ARowOfThePageIsWhatTheCommandSays) {
  std::vector<std::string> only{"--markdown"};
  for (const char* stage : {"boot", "approach", "tracking", "fault"}) {
    only.insert(only.end(), {"--only", std::string("home.") + stage + ".packet_loss.severe"});
  }
  const test::ProgramResult result = Faults(only);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string page = Content(test::SourceRoot() / "sim/FAULTS.md");
  std::istringstream lines(result.out);
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| ", 0) == 0) {  // of the lists of stages and faults, and the row itself
      EXPECT_THAT(page, HasSubstr(line + "\n"));
      ++rows;
    }
  }
  EXPECT_GE(rows, 19 + 5 + 2);

  // What is done is not done again, and the machine is told the same.
  const std::string before = Content(folder_.path() / "out" / "rows.jsonl");
  only[0] = "--json";
  only.emplace_back("--resume");
  const test::ProgramResult again = Faults(only);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.err, "");
  const std::string after = Content(folder_.path() / "out" / "rows.jsonl");
  EXPECT_EQ(after.size(), before.size());
  const json figures = json::parse(again.out);
  EXPECT_EQ(figures["undefined"], 0);
  EXPECT_EQ(figures["exceeded"], 0);
  ASSERT_EQ(figures["cells"].size(), 4U);
  for (const json& cell : figures["cells"]) {
    EXPECT_EQ(cell["end"], "safe stop") << cell;
    EXPECT_EQ(cell["noticed_by"], "state_missing");
    EXPECT_EQ(cell["ticks"], 0);
    for (const char* limit : {"joint_position", "joint_velocity", "torque", "torque_rate"}) {
      EXPECT_LE(cell["limits"][limit].get<double>(), 1.0 + 1e-9);
    }
  }
  EXPECT_THAT(Content(folder_.path() / "out" / "atlas.html"), HasSubstr("4 of 4 cells sound"));
}

TEST_F(FaultMatrixTest, ThePageIsSound) {
  const std::string page = Content(test::SourceRoot() / "sim/FAULTS.md");
  EXPECT_THAT(page, HasSubstr("- the arm touched bench, target or itself in 0\n"));
  EXPECT_THAT(page, HasSubstr(" went on, 0 undefined; a limit exceeded in 0\n"));
  EXPECT_THAT(page, HasSubstr("- the arm moved too far or too fast while it should have stood in 0\n"));
  EXPECT_THAT(page, testing::Not(HasSubstr("a part of the matrix")));
  for (const char* mode : {"## `ball`", "## `ball-moving`", "## `home`", "## `flange-circle`"}) {
    EXPECT_THAT(page, HasSubstr(mode));
  }
}

TEST_F(FaultMatrixTest, RefusesInOneLine) {
  const test::ProgramResult none = Faults({"--only", "ball.lunch"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--only leaves no cell"));
  EXPECT_EQ(Faults({"--target", "sphere"}).exit_code, 2);
  EXPECT_EQ(Faults({"--runs", "3"}).exit_code, 2);
  EXPECT_EQ(Faults({"--json", "--markdown"}).exit_code, 2);
  EXPECT_EQ(Faults({"--set", "servo.lambda=3"}).exit_code, 2);
  EXPECT_EQ(test::RunProgram({FOVEA_PROGRAM, "atlas", "--target", "sphere", "--only", "x"}).exit_code, 2);
}

}  // namespace
}  // namespace fovea
