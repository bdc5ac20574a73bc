// SPDX-License-Identifier: Apache-2.0
// The detector over a run's log raises its flag in the tick in which the servo did.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/places.hpp"
#include "tests/support/program.hpp"
#include "tools/fovea/contact/recording.hpp"

namespace fovea::contact {
namespace {

struct Case {
  const char* name;
  std::vector<std::string> settings;
  double total = 0.2;  // the limits of the run
  double sudden = 0.1;
  std::size_t by = 0;  // the detector that raises the flag; kDetectors.size(): none does
};

class ContactRecordingTest : public testing::TestWithParam<Case> {
 protected:
  const test::TempFolder folder_;
};

TEST_P(ContactRecordingTest, FlagIsThatOfTheTick) {
  std::vector<std::string> command{
      FOVEA_SIM_PROGRAM,   "run", "home", "--json", "--out", folder_.path() / "run", "--set",
      "run.duration_s=1.5"};
  for (const std::string& setting : GetParam().settings) {
    command.insert(command.end(), {"--set", setting});
  }
  config::SafetyConfig safety;
  safety.contact_torque_fraction = GetParam().total;
  safety.contact_sudden_fraction = GetParam().sudden;
  command.insert(command.end(),
                 {"--set", "safety.contact_torque_fraction=" + std::to_string(GetParam().total), "--set",
                  "safety.contact_sudden_fraction=" + std::to_string(GetParam().sudden)});
  ASSERT_LE(test::RunProgram(command, {}, std::chrono::seconds(120)).exit_code, 1);
  const Recording recording = ReadRecording(folder_.path() / "run", SuddenWeight(safety));
  ASSERT_GT(recording.ticks.size(), 50U);
  const auto over = [&](const WatchedTick& tick) {
    return tick.share[static_cast<std::size_t>(Detector::kBoth)] > safety.contact_torque_fraction;
  };
  const auto first = std::find_if(recording.ticks.begin(), recording.ticks.end(), over);
  if (GetParam().by == kDetectors.size()) {
    EXPECT_EQ(recording.fault, "");
    EXPECT_EQ(first, recording.ticks.end());
    return;
  }
  ASSERT_NE(first, recording.ticks.end());
  std::cout << "flag at " << first->t_s << " s, fault " << recording.fault << " at " << recording.fault_s
            << " s\n";
  EXPECT_EQ(recording.fault, "contact");
  EXPECT_EQ(first->t_s, recording.fault_s);
  const bool by_total = first->share[0] > safety.contact_torque_fraction;
  EXPECT_EQ(by_total, GetParam().by == 0);
}

INSTANTIATE_TEST_SUITE_P(
    Runs, ContactRecordingTest,
    testing::Values(
        Case{"untouched", {}, 0.2, 0.1, kDetectors.size()},
        Case{"sudden", {"faults.push=[0, 14, 0, 0, 0, 0, 0]", "faults.push_s=[0.6, 0.9]"}, 0.2, 0.1, 1},
        Case{"wrong_masses", {"truth.arm.link_mass.scale=1.2"}, 0.07, 0.1, 0}),
    [](const auto& given) { return std::string(given.param.name); });

// The runs of one motion.
TEST(ContactAtlasTest, OneMotionGivesAPageAndTheSameFiguresAgain) {
  const test::TempFolder folder;
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{FOVEA_PROGRAM, "atlas", "--contact",          "--only",
                                       "home",        "--out", folder.path() / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::RunProgram(arguments, {}, std::chrono::seconds(500));
  };
  const test::ProgramResult first = run({"--json"});
  ASSERT_LE(first.exit_code, 1) << first.err;
  const auto json = nlohmann::json::parse(first.out);
  const auto& both = json.at("detectors").at("both").at("wrong");
  EXPECT_EQ(both.size(), 40U);
  int detected = 1'000'000;  // a higher threshold never gives more, above what is there before a push
  for (std::size_t i = 10; i < both.size(); ++i) {
    int sum = 0;
    for (const auto& push : both[i].at("pushes")) {
      sum += push.at("detected").get<int>();
    }
    EXPECT_LE(sum, detected);
    detected = sum;
  }
  EXPECT_EQ(both.back().at("false_alarms"), 0);
  const test::ProgramResult again = run({"--json", "--resume"});
  EXPECT_EQ(again.out, first.out);
  std::ifstream stream(folder.path() / "out" / "atlas.html");
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_THAT(run({"--only", "dance"}).err, testing::HasSubstr("--only dance: no such motion"));
}

}  // namespace
}  // namespace fovea::contact
