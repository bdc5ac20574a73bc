// SPDX-License-Identifier: Apache-2.0
// Wrong usage: exit code 2, and one line with the program's name and the allowed values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class UsageTest : public testing::Test {
 protected:
  // The last line of the program's error; only progress lines may precede it.
  static std::string Refusal(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FOVEA_SIM_PROGRAM);
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.err.ends_with('\n')) << result.err;
    const std::string line = result.err.substr(0, result.err.size() - 1);
    const std::string last = line.substr(line.find_last_of('\n') + 1);
    EXPECT_THAT(last, testing::StartsWith("fovea-sim: "));
    return last;
  }

  TempFolder folder_;
};

TEST_F(UsageTest, WrongUsageNamesWhatIsAllowed) {
  const std::string commands = "allowed: run, runs, serve, pictures, list, keys";
  EXPECT_THAT(Refusal({}), HasSubstr(commands));
  EXPECT_THAT(Refusal({"fly"}), AllOf(HasSubstr("fly"), HasSubstr(commands)));
  EXPECT_THAT(Refusal({"run"}), AllOf(HasSubstr("scenario is required"), HasSubstr("--set")));
  EXPECT_THAT(Refusal({"run", "ball", "--sed", "1"}), AllOf(HasSubstr("--sed"), HasSubstr("--seed")));
  EXPECT_THAT(Refusal({"run", "ball", "--seed", "-3"}), AllOf(HasSubstr("--seed"), HasSubstr("2147483647")));
  EXPECT_THAT(Refusal({"run", "ball", "--seed"}), HasSubstr("--seed"));
  EXPECT_THAT(Refusal({"run", "ball", "--pace", "slow"}), HasSubstr("{lockstep,real}"));
}

// CLI11's range checks accept NaN.
TEST_F(UsageTest, NonFiniteNumberIsRefused) {
  for (const char* number : {"nan", "-nan", "inf", "-inf", "1e999"}) {
    for (const char* option : {"--line-loss", "--line-delay-ms", "--line-from-s"}) {
      const std::string given = std::string(option) + "=" + number;
      EXPECT_THAT(Refusal({"run", "ball", "--servo", "mcu", "--servo-pace", "timer", given}),
                  AllOf(HasSubstr(option), HasSubstr(number)));
    }
    for (const char* option : {"--most-speed", "--loss", "--delay-ms"}) {
      const std::string given = std::string(option) + "=" + number;
      EXPECT_THAT(Refusal({"serve", "ball", given}), AllOf(HasSubstr(option), HasSubstr(number)));
    }
    EXPECT_THAT(Refusal({"run", "ball", "--set", std::string("run.duration_s=") + number}),
                HasSubstr("run.duration_s"));
  }
  const fs::path file = folder_.path() / "mine.toml";
  std::ofstream(file) << "[run]\nduration_s = nan\n";
  EXPECT_THAT(Refusal({"run", file}), AllOf(HasSubstr("mine.toml:2"), HasSubstr("run.duration_s = nan")));
}

TEST_F(UsageTest, FolderInPlaceOfATomlFileIsRefused) {
  const fs::path folder = folder_.path() / "x.toml";
  fs::create_directory(folder);
  EXPECT_EQ(Refusal({"run", folder}),
            "fovea-sim: " + folder.string() + ": is a folder; a TOML file is allowed");
  EXPECT_THAT(Refusal({"run", "ball", "--set", "arm.model=\"" + folder.string() + "\""}),
              HasSubstr(folder.string() + ": is a folder"));
}

}  // namespace
}  // namespace fovea::test
