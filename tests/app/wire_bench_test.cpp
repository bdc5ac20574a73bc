// `fovea-bench wire` from outside: it starts the simulated robot by itself, and its figures have their names.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/program.hpp"

namespace fovea::test {
namespace {

TEST(WireBench, HasItsFigures) {
  const ProgramResult run = RunProgram({FOVEA_BENCH_PROGRAM, "wire", "--seconds", "1", "--json"});
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
}

}  // namespace
}  // namespace fovea::test
