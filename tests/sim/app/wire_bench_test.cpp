// SPDX-License-Identifier: Apache-2.0
// `fovea-bench wire` from outside: it starts the simulated robot itself and reports all figures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.hpp"

namespace fovea::test {
namespace {

using testing::HasSubstr;

// In lockstep the robot waits for its client: the counts are the same on any machine.
TEST(WireBench, ReportsEveryFigure) {
  const ProgramResult run =
      RunProgram({FOVEA_BENCH_PROGRAM, "wire", "--pace", "lockstep", "--seconds", "1", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> figures;
  for (const nlohmann::json& figure : nlohmann::json::parse(run.out)) {
    figures[figure["name"]] = figure["value"];
  }
  for (const char* name : {"states_per_s", "state_gap_p50_us", "state_gap_p99_us", "state_gap_max_us",
                           "lost_states", "command_success_rate"}) {
    EXPECT_EQ(figures.count(name), 1U) << name;
  }
  EXPECT_GT(figures["states_per_s"], 0.0);
  EXPECT_EQ(figures["lost_states"], 0.0);
  EXPECT_EQ(figures["command_success_rate"], 1.0);
  EXPECT_GE(figures["answered_states"], 0.99);
  EXPECT_LE(figures["answered_states"], 1.01);
}

// Runs the bench as process $b of a shell, then `script` once `ready` is true for its robot, process $c.
ProgramResult WithItsRobot(const std::string& ready, const std::string& script) {
  return RunProgram({"sh", "-c",
                     R"("$0" wire --pace lockstep --seconds 100000 & b=$!
until read -r c rest < /proc/$b/task/$b/children || [ "$c" ] && )" +
                         ready + R"(; do
  kill -0 $b || break
  sleep 0.05
done 2> /dev/null
)" + script,
                     FOVEA_BENCH_PROGRAM});
}

TEST(WireBench, EndedMotionFailsWithItsReason) {
  // Waits until a thread blocks just the signals of its queue (HUP, INT, USR1, TERM), then presses the stop
  // button, and again every ten seconds until it has an effect.
  const ProgramResult run = WithItsRobot(
      "readlink /proc/$c/exe | grep -q 'fovea-sim$' && grep -q 'SigBlk:.*4203$' "
      "/proc/$c/task/*/status",
      R"(for k in $(seq 500); do
  [ $((k % 100)) = 1 ] && kill -USR1 $c 2> /dev/null
  grep -q '^State:.[^Z]' /proc/$b/status 2> /dev/null || break
  sleep 0.1
done
wait $b)");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "") << "no figures after an ended motion";
  EXPECT_THAT(run.err, HasSubstr("(user stop)"));
}

TEST(WireBench, RobotProcessEndsWithTheBench) {
  const ProgramResult run =
      WithItsRobot("readlink /proc/$c/exe | grep -q 'fovea-sim$'", R"(kill -KILL $b || exit 3
for k in $(seq 600); do
  grep -q '^State:.[^Z]' /proc/$c/status 2> /dev/null || exit 0
  sleep 0.1
done
kill -KILL $c
exit 1)");
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

}  // namespace
}  // namespace fovea::test
