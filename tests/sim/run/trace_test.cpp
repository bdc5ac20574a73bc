// SPDX-License-Identifier: Apache-2.0
// The timeline that `fovea-sim run --trace` writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "firmware/core/task/stage_probe.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Nanoseconds; the file has microseconds with three decimals.
std::int64_t Ns(const json& us) { return std::llround(us.get<double>() * 1000.0); }

struct Timeline {
  json summary;
  std::map<std::string, std::vector<json>> spans;        // by thread name, in the file's order
  std::map<std::string, std::set<std::int64_t>> arrows;  // picture numbers, by phase
  std::uint64_t dropped = 0;
};

Timeline TimelineOf(const std::vector<std::string>& more) {
  const TempFolder folder;
  const fs::path file = folder.path() / "trace.json";
  std::vector<std::string> arguments{FOVEA_SIM_PROGRAM,     "run",         "ball",  "--trace", file, "--out",
                                     folder.path() / "out", "--no-report", "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramResult run = RunProgram(arguments);
  EXPECT_NE(run.exit_code, 2) << run.err;
  Timeline timeline;
  timeline.summary = json::parse(run.out);
  std::ifstream stream(file);
  const json trace = json::parse(stream);
  timeline.dropped = trace["otherData"]["dropped"];
  std::map<int, std::string> threads;
  for (const json& event : trace["traceEvents"]) {
    const std::string phase = event["ph"];
    if (phase == "M") {
      if (event["name"] == "thread_name") {
        threads[event["tid"]] = event["args"]["name"];
      }
    } else if (phase == "X" || phase == "i") {
      const auto thread = threads.find(event["tid"]);
      EXPECT_NE(thread, threads.end()) << "a thread without a name: " << event;
      timeline.spans[thread->second].push_back(event);
    } else {
      timeline.arrows[phase].insert(event["id"].get<std::int64_t>());
    }
  }
  return timeline;
}

// Within a thread each span lies inside the open one, or after it.
void ExpectNesting(const std::string& thread, const std::vector<json>& spans) {
  std::vector<std::int64_t> open;  // ends
  std::int64_t last_ns = 0;
  for (const json& span : spans) {
    const std::int64_t begin_ns = Ns(span["ts"]);
    const std::int64_t end_ns = begin_ns + (span.contains("dur") ? Ns(span["dur"]) : 0);
    EXPECT_GE(begin_ns, last_ns) << thread << ": " << span;
    last_ns = begin_ns;
    while (!open.empty() && open.back() <= begin_ns) {
      open.pop_back();
    }
    EXPECT_TRUE(open.empty() || end_ns <= open.back()) << thread << ": " << span << " ends outside";
    open.push_back(end_ns);
  }
}

std::map<std::string, int> CountByName(const std::vector<json>& spans) {
  std::map<std::string, int> counts;
  for (const json& span : spans) {
    ++counts[span["name"]];
  }
  return counts;
}

class TracedRun : public testing::TestWithParam<const char*> {};

TEST_P(TracedRun, EveryTickIsTracedWithinItsThread) {
  // At real pace long enough for some pictures on a slow machine, also under the thread sanitizer.
  const char* duration = GetParam() == std::string("real") ? "run.duration_s=4" : "run.duration_s=1";
  const Timeline timeline = TimelineOf({"--pace", GetParam(), "--set", duration});
  EXPECT_EQ(timeline.dropped, 0U);
  std::set<std::string> threads;
  for (const auto& [thread, spans] : timeline.spans) {
    threads.insert(thread);
    ExpectNesting(thread, spans);
  }
  // At real pace one renderer may have drawn all pictures.
  const bool one = threads.erase("renderer 0") + threads.erase("renderer 1") > 0;
  EXPECT_TRUE(one);
  EXPECT_EQ(threads, (std::set<std::string>{"servo and world", "vision"}));

  const int ticks = timeline.summary["ticks"];
  const std::vector<json>& servo = timeline.spans.at("servo and world");
  std::int64_t tick = 0;
  std::int64_t open_until_ns = 0;
  int stages = 0;
  const std::set<std::string> names(task::kStageNames.begin(), task::kStageNames.end());
  for (const json& span : servo) {
    if (span["name"] == "tick") {
      EXPECT_EQ(span["args"]["number"], tick++);
      open_until_ns = Ns(span["ts"]) + Ns(span["dur"]);
    } else if (names.count(span["name"]) > 0) {
      ++stages;
      EXPECT_LE(Ns(span["ts"]), open_until_ns) << "a stage outside a tick: " << span;
    }
  }
  EXPECT_EQ(tick, ticks);
  EXPECT_EQ(stages, ticks * static_cast<int>(names.size()));

  const std::map<std::string, int> in_vision = CountByName(timeline.spans.at("vision"));
  EXPECT_EQ(in_vision.at("detect"), timeline.summary["frames"]);
  std::set<std::int64_t> drawn;
  for (const char* renderer : {"renderer 0", "renderer 1"}) {
    if (timeline.spans.count(renderer) == 0) {
      continue;
    }
    for (const json& span : timeline.spans.at(renderer)) {
      if (span["name"] == "draw") {
        EXPECT_TRUE(drawn.insert(span["args"]["number"].get<std::int64_t>()).second) << span;
      }
    }
  }
  // A tick can only take a picture that was drawn and processed.
  EXPECT_EQ(timeline.arrows.at("s"), drawn);
  EXPECT_FALSE(timeline.arrows.at("f").empty());
  for (const std::int64_t picture : timeline.arrows.at("f")) {
    EXPECT_EQ(timeline.arrows.at("t").count(picture), 1U) << picture;
    EXPECT_EQ(drawn.count(picture), 1U) << picture;
  }
}

INSTANTIATE_TEST_SUITE_P(Paces, TracedRun, testing::Values("real", "lockstep"),
                         [](const auto& pace) { return std::string(pace.param); });

// Tracing does not change the run.
TEST(TraceTest, TracingDoesNotChangeTheRun) {
  const TempFolder folder;
  const Timeline traced = TimelineOf({"--set", "run.duration_s=0.5"});
  const ProgramResult plain = RunProgram({FOVEA_SIM_PROGRAM, "run", "ball", "--set", "run.duration_s=0.5",
                                          "--out", folder.path() / "out", "--no-report", "--json"});
  EXPECT_EQ(traced.summary["log_hash"], json::parse(plain.out)["log_hash"]);
}

// Each share is positive; the shares of one thread sum to at most
// 1, those of the camera to at most its number of threads.
TEST(TraceTest, BenchReportsTheTimeShares) {
  const ProgramResult run =
      RunProgram({FOVEA_BENCH_PROGRAM, "sim", "--shares", "--seconds", "0.5", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> value;
  for (const json& figure : json::parse(run.out)) {
    value[figure["name"]] = figure["value"];
  }
  for (const char* name :
       {"share_physics", "share_servo", "share_render", "share_read_back", "share_sensor", "share_detection",
        "share_logging", "physics_us_1_joint", "physics_us_6_joints", "physics_us_7_joints",
        "picture_ms_320x240", "picture_ms_640x480", "picture_ms_1280x960", "picture_ms_clutter"}) {
    ASSERT_EQ(value.count(name), 1U) << name;
    EXPECT_GT(value[name], 0.0) << name;
  }
  EXPECT_LE(value["share_physics"] + value["share_servo"], 1.0);
  EXPECT_LE(value["share_detection"], 1.0);
  EXPECT_LE(value["share_render"] + value["share_read_back"] + value["share_sensor"], 2.0);
}

TEST(TraceTest, UnwritableTraceFileIsRefused) {
  const TempFolder folder;
  const ProgramResult run = RunProgram(
      {FOVEA_SIM_PROGRAM, "run", "ball", "--trace", "/nowhere/to/be/t.json", "--out", folder.path() / "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, testing::HasSubstr("--trace /nowhere/to/be/t.json: cannot be written"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace fovea::test
