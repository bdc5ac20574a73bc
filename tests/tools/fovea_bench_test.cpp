// `fovea-bench` from outside: its figures have the names that others script against. How large they are is no
// test's business.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "support/program.hpp"

namespace fovea {
namespace {

using nlohmann::json;
using testing::HasSubstr;

test::ProgramResult Bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), FOVEA_BENCH_PROGRAM);
  return test::RunProgram(arguments);
}

// The names in a list of {name, value, unit, goal}, each of which has a value.
std::set<std::string> NamesOf(const test::ProgramResult& run) {
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::set<std::string> names;
  for (const json& figure : json::parse(run.out)) {
    EXPECT_TRUE(figure.contains("goal") && figure.contains("unit")) << figure;
    EXPECT_TRUE(figure["value"].is_number()) << figure;
    EXPECT_TRUE(names.insert(figure["name"]).second) << figure["name"] << " stands there twice";
  }
  return names;
}

TEST(FoveaBench, TickHasItsFigures) {
  const std::set<std::string> names = NamesOf(Bench({"tick", "--runs", "1", "--json"}));
  for (const char* name : {"model_ns", "model_kdl_ns", "visual_law_ns", "tick_ns_p50", "tick_cold_ns_p50",
                           "tick_random_ns_max", "tick_commanded_ns_p50", "tick_boot_ns_p50",
                           "tick_hold_ns_p50", "tick_track_ns_p50", "tick_coast_ns_p50", "tick_move_ns_p50",
                           "tick_fault_ns_p50", "stage_model_ns", "stage_reference_ns"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

TEST(FoveaBench, JitterHasItsFigures) {
  const std::set<std::string> names =
      NamesOf(Bench({"jitter", "--seconds", "1", "--policy", "other", "--json"}));
  for (const char* name : {"wake_us_p999", "execute_us_p50", "response_us_max", "sleeper_wake_us_p999",
                           "wake_ratio_p999", "servo_overruns", "servo_page_faults"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

TEST(FoveaBench, CompareTellsMoreFromLess) {
  const test::TempFolder folder;
  const auto write = [&](const char* name, double a) {
    const std::string file = folder.path() / name;
    std::ofstream(file) << json::array(
        {{{"name", "a"}, {"value", a}, {"unit", "ns"}, {"goal", nullptr}},
         {{"name", "b"}, {"value", nullptr}, {"unit", "ns"}, {"goal", nullptr}}});
    return file;
  };
  const std::string small = write("old.json", 100.0);
  const std::string large = write("new.json", 120.0);
  EXPECT_EQ(Bench({"compare", small, large, "--most", "1.3"}).exit_code, 0);
  EXPECT_EQ(Bench({"compare", small, large, "--most", "1.1"}).exit_code, 1);
  EXPECT_EQ(Bench({"compare", large, small, "--most", "1.1"}).exit_code, 0);
  EXPECT_THAT(Bench({"compare", small, large}).out, HasSubstr("1.200"));
  std::ofstream(folder.path() / "empty.json") << "[]";
  EXPECT_EQ(Bench({"compare", small, folder.path() / "empty.json", "--most", "1.1"}).exit_code, 2);
  std::ofstream(folder.path() / "none.json") << "{";
  EXPECT_EQ(Bench({"compare", small, folder.path() / "none.json"}).exit_code, 2);
}

TEST(FoveaBench, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(Bench({"nix"}).exit_code, 2);
  EXPECT_EQ(Bench({"jitter", "--load", "nix"}).exit_code, 2);
  const test::ProgramResult run = Bench({"tick", "--robot", "nix"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no shipped arm of that name"));
}

}  // namespace
}  // namespace fovea
