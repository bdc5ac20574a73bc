// SPDX-License-Identifier: Apache-2.0
// Whether findings are judged rightly, and the program on two runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/fovea/findings/coverage.hpp"

namespace fovea::findings {
namespace {

// Errors of standard deviation 1, stated as `stated`.
std::vector<Finding> Normal(int runs, double stated) {
  std::mt19937 random(5);
  std::normal_distribution<double> error;
  std::uniform_real_distribution<double> truth(-10.0, 10.0);
  std::vector<Finding> findings;
  for (int i = 0; i < runs; ++i) {
    const double value = truth(random);
    findings.push_back({true, value + error(random), stated, value});
  }
  return findings;
}

TEST(CoverageTest, OfHonestErrors) {
  const Coverage coverage = CoverageOf(Normal(10000, 1.0));
  EXPECT_EQ(coverage.known, 10000);
  EXPECT_NEAR(coverage.WithinShare(), 0.9545, 0.006);
  EXPECT_NEAR(coverage.error_rms, 1.0, 0.02);
  EXPECT_DOUBLE_EQ(coverage.sigma_largest, 1.0);
  EXPECT_TRUE(Meets(coverage, {1.0}));
  EXPECT_FALSE(Meets(coverage, {0.99})) << "less sure than asked";
}

TEST(CoverageTest, TooSureOrTooCautiousIsNotGood) {
  EXPECT_FALSE(Meets(CoverageOf(Normal(1000, 0.7)), {10.0}));
  EXPECT_FALSE(Meets(CoverageOf(Normal(1000, 2.0)), {10.0}));
}

TEST(CoverageTest, UnknownFindingsDoNotCountAsErrors) {
  std::vector<Finding> findings = Normal(1000, 1.0);
  for (int i = 0; i < 40; ++i) {
    findings[static_cast<std::size_t>(i)] = {false, 1e9, 1e-9, 0.0};
  }
  const Coverage coverage = CoverageOf(findings);
  EXPECT_EQ(coverage.known, 960);
  EXPECT_TRUE(Meets(coverage, {1.0}));
  for (int i = 40; i < 60; ++i) {
    findings[static_cast<std::size_t>(i)].known = false;
  }
  EXPECT_FALSE(Meets(CoverageOf(findings), {1.0})) << "known in 94 %";
  EXPECT_FALSE(Meets(CoverageOf({}), {1.0}));
}

TEST(FindingsProgram, ComparesWhatWasFoundWithWhatWasDrawn) {
  const test::TempFolder folder;
  const test::ProgramResult result =
      test::RunProgram({FOVEA_PROGRAM, "atlas", "--findings", "--runs", "2", "--seed", "2001", "--jobs", "2",
                        "--json", "--out", folder.path() / "out"},
                       {}, std::chrono::seconds(300));
  ASSERT_LE(result.exit_code, 1) << result.err;  // two runs are too few for a coverage
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("unfinished"), 0);
  ASSERT_EQ(json.at("beliefs").size(), 6U);
  for (const auto& [name, belief] : json.at("beliefs").items()) {
    EXPECT_EQ(belief.at("known"), 2) << name;
    EXPECT_LE(belief.at("error_largest"), 4.0 * belief.at("sigma_largest").get<double>()) << name;
    EXPECT_LE(belief.at("sigma_largest"), belief.at("sigma_most")) << name;
  }
}

TEST(FindingsProgram, RefusesWhatItWouldNotUse) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{"--truth", "uncertain"}, {"--set", "run.duration_s=1"}, {"--draw-only"}}) {
    std::vector<std::string> arguments{FOVEA_PROGRAM, "atlas", "--findings"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const test::ProgramResult result = test::RunProgram(arguments, {}, std::chrono::seconds(30));
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, testing::HasSubstr(more.front()));
  }
}

}  // namespace
}  // namespace fovea::findings
