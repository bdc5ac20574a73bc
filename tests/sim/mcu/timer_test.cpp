// SPDX-License-Identifier: Apache-2.0
// The board paced by its own timer in virtual time, with the simulator.
#include <gtest/gtest.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/sim/mcu/run_sim.hpp"

namespace fovea {
namespace {

using Words = std::vector<std::string>;

Words With(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

const Words kByTimer{"--servo-pace", "timer", "--instruction-ns", "4"};
// Without a camera, so that only line and board matter.
const Words kHome{"ball", "--set", "camera.enabled=false", "--set", "motion.kind=home"};

nlohmann::json OnTheBoard(const Words& words) {
  nlohmann::json summary = test::RunSim(words, "mcu");
  EXPECT_TRUE(summary.is_object());
  return summary;
}

TEST(BoardByTimer, PerfectLineMatchesTheComputerBitExact) {
  const Words run = With(kHome, {"--set", "run.duration_s=0.3"});
  const nlohmann::json here = test::RunSim(run, "pc");
  const nlohmann::json there = OnTheBoard(With(run, kByTimer));
  EXPECT_EQ(there["log_hash"], here["log_hash"]);
  EXPECT_EQ(there["mcu"]["pace"], "timer");
  for (const auto& [name, count] : there["mcu"]["line"].items()) {
    EXPECT_EQ(count, 0) << name;
  }
}

TEST(BoardByTimer, ConvergesThroughJitterAndLoss) {
  const nlohmann::json run =
      OnTheBoard(With({"ball", "--set", "servo.lambda=4", "--set", "run.duration_s=2.4", "--line-delay-ms",
                       "0.2", "--line-jitter-ms", "0.95", "--line-loss", "0.01", "--line-from-s", "0.1"},
                      kByTimer));
  std::cout << run["verdict"] << ", " << run["final_error_px_rms"] << " px, " << run["final_error_mm"]
            << " mm; " << run["mcu"]["line"] << '\n';
  EXPECT_EQ(run["converged"], true);
  EXPECT_EQ(run["limit_violations"], 0) << run["limits"];
  EXPECT_TRUE(run["faults"].empty()) << run["faults"];
  EXPECT_GT(run["mcu"]["line"]["silent_ticks"], 200);
  EXPECT_GT(run["mcu"]["ticks_without_torque"], 200);
}

// Repeats bit-exactly with jitter, although the wall-clock timing differs.
TEST(BoardByTimer, RunRepeatsForTheSameSeed) {
  const Words run = With(With(kHome, kByTimer),
                         {"--line-jitter-ms", "3", "--line-from-s", "0.05", "--set", "run.duration_s=0.25"});
  const nlohmann::json once = OnTheBoard(run);
  const nlohmann::json again = OnTheBoard(run);
  EXPECT_EQ(once["log_hash"], again["log_hash"]);
  EXPECT_EQ(once["mcu"]["line"], again["mcu"]["line"]);
  EXPECT_GT(once["mcu"]["line"]["late_frames"], 0);
}

TEST(BoardByTimer, TooMuchJitterRaisesArmLostAndStops) {
  const nlohmann::json run =
      OnTheBoard(With(With(kHome, kByTimer),
                      {"--line-jitter-ms", "100", "--line-from-s", "0.3", "--set", "run.duration_s=0.5"}));
  std::cout << run["faults"] << "; " << run["mcu"]["line"] << '\n';
  ASSERT_FALSE(run["faults"].empty());
  EXPECT_EQ(run["faults"][0]["name"], "arm_lost");
  EXPECT_EQ(run["modes"].back()["mode"], "fault");
  EXPECT_EQ(run["limit_violations"], 0);
}

// A processor of 16 MIPS: a tick of 28 000 instructions takes two periods.
TEST(BoardByTimer, SlowProcessorMissesAndCountsItsDeadlines) {
  const nlohmann::json run = OnTheBoard(
      With(kHome, {"--servo-pace", "timer", "--instruction-ns", "64", "--set", "run.duration_s=0.3"}));
  EXPECT_GT(run["mcu"]["line"]["missed_ticks"], 50);
  // The run may end within a tick of up to three periods, which only one of the two counters may include.
  EXPECT_NEAR(run["mcu"]["line"]["missed_ticks"].get<int>(), run["missed_ticks"].get<int>(), 3);
  EXPECT_EQ(run["ticks"].get<int>() + run["missed_ticks"].get<int>(), 300);
  EXPECT_TRUE(run["faults"].empty()) << run["faults"];
}

}  // namespace
}  // namespace fovea
