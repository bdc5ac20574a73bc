// SPDX-License-Identifier: Apache-2.0
// `fovea atlas --faults`: real cells of the matrix match the page sim/FAULTS.md; errors are one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/places.hpp"
#include "tests/support/program.hpp"

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

// A silent arm for 0.1 s, at each stage of its motion home. After an intended change of the servo, renew the
// page with `fovea atlas --faults --markdown`.
TEST_F(FaultMatrixTest, PageRowMatchesTheCommandOutput) {
  std::vector<std::string> only{"--markdown"};
  for (const char* stage : {"boot", "approach", "tracking", "fault"}) {
    only.insert(only.end(), {"--only", std::string("home.") + stage + ".packet_loss.severe"});
  }
  const test::ProgramResult result = Faults(only);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string page = Content(test::SourceRoot() / "sim/FAULTS.md");
  const std::size_t row = result.out.find("| packet loss | severe |");
  ASSERT_NE(row, std::string::npos) << result.out;
  EXPECT_THAT(page, HasSubstr(result.out.substr(row, result.out.find('\n', row) + 1 - row)));
  // Open cases: never more than at the last review; the goal is none.
  const auto count = [&page](const std::string& before) {
    const std::size_t at = page.find(before);
    EXPECT_NE(at, std::string::npos) << before;
    return at == std::string::npos ? 1'000'000 : std::stoi(page.substr(at + before.size()));
  };
  EXPECT_LE(count(" went on, "), 2) << "undefined";
  EXPECT_LE(count("a limit exceeded in "), 0);
  EXPECT_LE(count("while it should have stood in "), 4);
  EXPECT_LE(count("touched bench, target or itself in "), 0);
  EXPECT_THAT(page, testing::Not(HasSubstr("a part of the matrix")));
  for (const char* mode : {"## `ball`", "## `ball-moving`", "## `home`", "## `flange-circle`"}) {
    EXPECT_THAT(page, HasSubstr(mode));
  }
}

TEST_F(FaultMatrixTest, RefusesBadOptionsInOneLine) {
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
