// SPDX-License-Identifier: Apache-2.0
// `fovea-bench` from outside: its figures have the names that scripts use. Their values are not tested.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "tests/support/program.hpp"

namespace fovea {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

test::ProgramResult Bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), FOVEA_BENCH_PROGRAM);
  return test::RunProgram(arguments);
}

// The names in a list of {name, value, unit, goal}. Checks that each has a value.
std::set<std::string> NamesOf(const test::ProgramResult& run) {
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::set<std::string> names;
  for (const json& figure : json::parse(run.out)) {
    EXPECT_TRUE(figure.contains("goal") && figure.contains("unit")) << figure;
    EXPECT_TRUE(figure["value"].is_number()) << figure;
    EXPECT_TRUE(names.insert(figure["name"]).second) << figure["name"] << " exists twice";
  }
  return names;
}

TEST(FoveaBench, TickReportsEveryFigure) {
  const std::set<std::string> names = NamesOf(Bench({"tick", "--runs", "1", "--json"}));
  for (const char* name : {"model_ns", "model_kdl_ns", "visual_law_ns", "tick_ns_p50", "tick_cold_ns_p50",
                           "tick_random_ns_max", "tick_commanded_ns_p50", "tick_boot_ns_p50",
                           "tick_hold_ns_p50", "tick_track_ns_p50", "tick_coast_ns_p50", "tick_move_ns_p50",
                           "tick_fault_ns_p50", "stage_model_ns", "stage_reference_ns"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

// The program fails if the twists of both differ.
TEST(FoveaBench, LawMatchesVispAndBothAreTimed) {
  const std::set<std::string> names = NamesOf(test::RunProgram({FOVEA_BENCH_VISP_PROGRAM, "--json"}));
  EXPECT_EQ(names, (std::set<std::string>{"fovea_law_ns", "visp_steps_ns", "visp_control_law_ns",
                                          "visp_steps_ratio", "visp_control_law_ratio"}));
}

std::string TextOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(FoveaBench, JitterReportsEveryFigure) {
  const test::TempFolder folder;
  const test::ProgramResult run =
      Bench({"jitter", "--seconds", "1", "--policy", "other", "--out", folder.path() / "j", "--json"});
  const std::set<std::string> names = NamesOf(run);
  for (const char* name :
       {"wake_us_p999", "execute_us_p50", "off_period_us_p9999", "response_us_max", "sleeper_wake_us_min",
        "stage_model_us_p50", "stage_record_us_max", "hop_arrival_us_p50", "hop_detection_us_p50",
        "hop_hand_over_us_p50", "hop_tick_us_p50", "image_to_torque_us_p50", "wake_ratio_p999",
        "wake_ratio_p999_low", "servo_overruns", "servo_page_faults", "servo_voluntary_switches",
        "sleeper_involuntary_switches"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
  EXPECT_EQ(json::parse(TextOf(folder.path() / "j" / "jitter.json")), json::parse(run.out));
}

// The load must come up: three viewers connect and stay.
TEST(FoveaBench, JitterIsMeasuredWithViewers) {
  const test::TempFolder folder;
  const test::ProgramResult run = Bench({"jitter", "--load", "viewers", "--seconds", "1", "--policy", "other",
                                         "--out", folder.path(), "--json"});
  EXPECT_EQ(NamesOf(run).count("wake_us_p999"), 1U) << run.err;
}

// A picture's delay is the sum of its hops: it lies between the sums of their minima and maxima.
TEST(FoveaBench, JitterHopsAddUp) {
  const test::TempFolder folder;
  const test::ProgramResult run =
      Bench({"jitter", "--seconds", "1", "--policy", "other", "--out", folder.path(), "--json"});
  std::map<std::string, double> value;
  for (const json& figure : json::parse(run.out)) {
    value[figure["name"]] = figure["value"];
  }
  double least = 0.0;
  double most = 0.0;
  for (const char* hop : {"hop_exposure", "hop_arrival", "hop_detection", "hop_hand_over", "hop_tick"}) {
    EXPECT_GE(value[fmt::format("{}_us_min", hop)], 0.0) << hop;
    least += value[fmt::format("{}_us_min", hop)];
    most += value[fmt::format("{}_us_max", hop)];
  }
  EXPECT_GE(value["pictures"], 1.0);
  EXPECT_GE(value["image_to_torque_us_min"], least - 1e-6);
  EXPECT_LE(value["image_to_torque_us_max"], most + 1e-6);
  EXPECT_GE(value["hop_exposure_us_min"] + value["hop_arrival_us_min"], 5500.0);  // the camera's delay
}

TEST(FoveaBench, JitterPageIsSelfContained) {
  const test::TempFolder folder;
  const std::string trace = folder.path() / "trace.json";
  const test::ProgramResult run =
      Bench({"jitter", "--seconds", "1", "--policy", "other", "--out", folder.path(), "--trace", trace});
  std::set<std::string> threads;
  std::map<std::string, int> spans;
  const json timeline = json::parse(TextOf(trace));
  for (const json& event : timeline["traceEvents"]) {
    if (event["name"] == "thread_name") {
      threads.insert(event["args"]["name"]);
    }
    ++spans[event["name"]];
  }
  EXPECT_EQ(threads, (std::set<std::string>{"camera", "servo", "sleeper", "vision"}));
  EXPECT_GT(spans["tick"], 0);
  EXPECT_EQ(spans["model"], spans["tick"]);
  EXPECT_GT(spans["detect"], 0);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* words : {"servo: wake-up", "picture to torque", "overruns", "1 kHz here", "p99.99"}) {
    EXPECT_THAT(run.out, HasSubstr(words));
  }
  const std::string page = TextOf(folder.path() / "jitter.html");
  for (const char* part : {"id=\"verdict\"", "Limits of this machine", "Wake-up latency",
                           "Stages of the tick", "From picture to torque", "sleeper: wake-up", "</html>"}) {
    EXPECT_THAT(page, HasSubstr(part));
  }
  for (const char* outside : {"http:", "https:", "src=", "href="}) {
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  }
}

TEST(FoveaBench, CompareFailsOnlyAboveTheAllowedRatio) {
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

// Without fovea-sim each command that needs it reports that before it writes anything.
TEST(FoveaBench, CommandWithoutTheSimulatorNamesTheMissingProgram) {
  const test::TempFolder folder;
  const std::filesystem::path bin = folder.path() / "bin";
  std::filesystem::create_directories(bin);
  std::filesystem::create_directory_symlink(
      std::filesystem::path(FOVEA_BENCH_PROGRAM).parent_path().parent_path() / "share",
      folder.path() / "share");
  std::filesystem::copy_file(FOVEA_BENCH_PROGRAM, bin / "fovea-bench");
  std::filesystem::copy_file(FOVEA_PROGRAM, bin / "fovea");
  const std::string out = folder.path() / "out";
  const std::vector<std::pair<std::string, std::vector<std::string>>> calls{
      {"fovea-bench sim", {bin / "fovea-bench", "sim"}},
      {"fovea-bench wire", {bin / "fovea-bench", "wire"}},
      {"fovea-bench mcu", {bin / "fovea-bench", "mcu"}},
      {"--load render",
       {bin / "fovea-bench", "jitter", "--load", "render", "--policy", "other", "--out", out}},
      {"fovea atlas", {bin / "fovea", "atlas", "--target", "sphere", "--out", out}}};
  for (const auto& [name, arguments] : calls) {
    const test::ProgramResult run = test::RunProgram(arguments);
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_THAT(run.err, HasSubstr((bin / "fovea-sim").string() + ": not found; " + name +
                                   " needs the simulator in the same folder"))
        << name;
    EXPECT_FALSE(std::filesystem::exists(out)) << name;
  }
}

TEST(FoveaBench, RefusesUnknownCommandsAndOptions) {
  EXPECT_EQ(Bench({"nix"}).exit_code, 2);
  EXPECT_EQ(Bench({"jitter", "--load", "nix"}).exit_code, 2);
  const test::ProgramResult run = Bench({"tick", "--robot", "nix"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--robot: unknown arm \"nix\"; shipped are gantry, panda, puma560"));
}

}  // namespace
}  // namespace fovea
