// `fovea-bench wire` from outside: it starts the simulated robot by itself, and its figures have their names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "support/program.hpp"

namespace fovea::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

// A machine that leaves twenty states in a row without an answer ends the motion: then once more.
ProgramResult MeasureForASecond() {
  constexpr int kTries = 5;
  ProgramResult run;
  for (int k = 0; k < kTries; ++k) {
    run = RunProgram({FOVEA_BENCH_PROGRAM, "wire", "--seconds", "1", "--json"});
    if (run.exit_code == 0 || run.err.find("communication_constraints_violation") == std::string::npos) {
      break;
    }
  }
  return run;
}

TEST(WireBench, HasItsFigures) {
  const ProgramResult run = MeasureForASecond();
  if (run.err.find("communication_constraints_violation") != std::string::npos) {
    GTEST_SKIP() << "the machine has no time: " << run.err;
  }
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
  EXPECT_GT(figures["command_success_rate"], 0.0) << "its motion began";
  EXPECT_GT(figures["answered_states"], 0.0);
  EXPECT_LE(figures["answered_states"], 1.0);
}

// Runs the bench as process $b of a shell, and `script` once `ready` holds for its robot, process $c.
ProgramResult WithItsRobot(const std::string& ready, const std::string& script) {
  return RunProgram({"sh", "-c",
                     R"("$0" wire --seconds 60 & b=$!
until read -r c rest < /proc/$b/task/$b/children || [ "$c" ] && )" +
                         ready + R"(; do
  kill -0 $b || break
  sleep 0.05
done 2> /dev/null
)" + script,
                     FOVEA_BENCH_PROGRAM});
}

TEST(WireBench, AMotionThatEndsIsSaid) {
  // Signals have their queue; then the stop button, and once more where nobody took notice for ten seconds. A
  // busy machine may have ended the motion before.
  const ProgramResult run = WithItsRobot(
      "readlink /proc/$c/exe | grep -q 'fovea-sim$' && grep -q 'SigBlk:.*[2367abef]..$' /proc/$c/status",
      R"(for k in $(seq 500); do
  [ $((k % 100)) = 1 ] && kill -USR1 $c 2> /dev/null
  grep -q '^State:.[^Z]' /proc/$b/status 2> /dev/null || break
  sleep 0.1
done
wait $b)");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "") << "no figures of a robot that stood";
  EXPECT_THAT(run.err, AnyOf(HasSubstr("(user stop)"), HasSubstr("(communication_constraints_violation)")));
}

TEST(WireBench, ItsRobotIsNotLeftBehind) {
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
