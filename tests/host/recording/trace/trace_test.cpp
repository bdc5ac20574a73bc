// SPDX-License-Identifier: Apache-2.0
// Timelines: the content of the trace file, and that tracing changes nothing in the traced run.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "firmware/host/recording/trace/tick_trace.hpp"
#include "firmware/host/recording/trace/vision_trace.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::trace {
namespace {

using nlohmann::json;

json WriteAndRead(const Trace& trace) {
  const test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "trace.json";
  trace.Write(file);
  std::ifstream stream(file);
  return json::parse(stream);
}

TEST(Trace, WritesTheChromeTraceFormat) {
  Trace trace("a program");
  Track& one = trace.AddTrack("one", 10);
  Track& two = trace.AddTrack("two", 10);
  one.Add({"inner", 2'000'000, 2'500'001, -1, Flow::kNone});
  one.Add({"outer", 2'000'000, 3'000'000, 7, Flow::kBegin});
  two.Add({"instant", 2'600'000, 2'600'000, 7, Flow::kEnd});
  const json file = WriteAndRead(trace);
  EXPECT_EQ(file["otherData"]["dropped"], 0);
  std::map<int, std::string> threads;
  std::vector<json> spans;
  std::vector<std::string> arrows;
  for (const json& event : file["traceEvents"]) {
    const std::string phase = event["ph"];
    if (phase == "M" && event["name"] == "thread_name") {
      threads[event["tid"]] = event["args"]["name"];
    } else if (phase == "X" || phase == "i") {
      spans.push_back(event);
    } else if (phase != "M") {
      EXPECT_EQ(event["id"], 7);
      arrows.push_back(phase);
    }
  }
  ASSERT_EQ(spans.size(), 3U);
  // Of two spans with the same start the outer one comes first; times count from the earliest span.
  EXPECT_EQ(spans[0]["name"], "outer");
  EXPECT_EQ(spans[0]["ts"], 0.0);
  EXPECT_EQ(spans[0]["dur"], 1000.0);
  EXPECT_EQ(spans[0]["args"]["number"], 7);
  EXPECT_EQ(spans[1]["name"], "inner");
  EXPECT_EQ(spans[1]["dur"], 500.001);
  EXPECT_EQ(spans[2]["ph"], "i");
  EXPECT_EQ(spans[2]["ts"], 600.0);
  EXPECT_EQ(threads[spans[0]["tid"]], "one");
  EXPECT_EQ(threads[spans[2]["tid"]], "two");
  EXPECT_EQ(arrows, (std::vector<std::string>{"s", "f"}));
}

TEST(Trace, SpansWithoutRoomAreCounted) {
  Trace trace("a program");
  Track& track = trace.AddTrack("one", 2);
  for (int i = 0; i < 5; ++i) {
    track.Add({"span", i, i + 1, -1, Flow::kNone});
  }
  EXPECT_EQ(track.dropped(), 3U);
  EXPECT_EQ(track.Spans().size(), 2U);
  EXPECT_EQ(WriteAndRead(trace)["otherData"]["dropped"], 3);
}

TEST(Trace, UnwritableFileThrows) {
  EXPECT_THROW(Trace("a program").Write("/nowhere/to/be/trace.json"), std::runtime_error);
}

class CountingProbe final : public hal::TickProbe {
 public:
  void Enter() noexcept override { ++entered; }
  void Leave() noexcept override { ++left; }
  int entered = 0;
  int left = 0;
};

class CountingRecorder final : public hal::Recorder {
 public:
  void Record(const hal::TickRecord& record) noexcept override { last = record.tick; }
  std::uint64_t last = 0;
};

TEST(Trace, TickTraceForwardsToProbeAndRecorder) {
  Track track("servo", 100);
  CountingProbe probe;
  CountingRecorder recorder;
  TickTrace tick(track, probe, recorder);
  tick.Enter();
  for (std::size_t i = 0; i < task::kStageNames.size(); ++i) {
    tick.MarkStageEnd(static_cast<task::Stage>(i));
  }
  hal::TickRecord record;
  record.tick = 41;
  record.has_feature = true;
  record.feature.sequence = 5;
  tick.Record(record);
  tick.Leave();
  EXPECT_EQ(probe.entered, 1);
  EXPECT_EQ(probe.left, 1);
  EXPECT_EQ(recorder.last, 41U);
  const std::vector<Span> spans = track.Spans();
  ASSERT_EQ(spans.size(), kSpansPerTick);
  EXPECT_STREQ(spans.front().name, "tick");
  EXPECT_EQ(spans.front().number, 41);
  EXPECT_STREQ(spans.back().name, "write");
  EXPECT_EQ(spans.back().number, 5);
  EXPECT_EQ(spans.back().flow, Flow::kEnd);
  EXPECT_EQ(spans.back().end_ns, spans.front().end_ns);
}

}  // namespace
}  // namespace fovea::trace
