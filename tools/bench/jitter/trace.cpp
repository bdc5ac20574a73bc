// SPDX-License-Identifier: Apache-2.0
// The result as a timeline. It uses times that the threads record anyway, so it costs them nothing.
#include <numeric>

#include "firmware/host/recording/trace/trace.hpp"
#include "tools/bench/jitter/result.hpp"

namespace fovea::bench {
namespace {

using trace::Flow;

std::size_t PeriodsOf(const std::vector<Block>& blocks) {
  return std::accumulate(blocks.begin(), blocks.end(), std::size_t{0},
                         [](std::size_t sum, const Block& block) { return sum + block.periods.size(); });
}

void AddTick(const Period& period, std::int64_t number, trace::Track& track) {
  std::int64_t at_ns = period.deadline_ns + period.wake_ns;
  track.Add({"wake-up", period.deadline_ns, at_ns, -1, Flow::kNone});
  track.Add({"tick", at_ns, at_ns + period.execute_ns, number, Flow::kNone});
  for (std::size_t stage = 0; stage < task::kStageNames.size(); ++stage) {
    track.Add({task::kStageNames[stage], at_ns, at_ns + period.stage_ns[stage], -1, Flow::kNone});
    at_ns += period.stage_ns[stage];
  }
}

}  // namespace

void WriteJitterTrace(const JitterResult& result, const std::string& file) {
  trace::Trace timeline("fovea-bench jitter");
  trace::Track& servo = timeline.AddTrack(
      "servo", PeriodsOf(result.servo) * (task::kStageNames.size() + 2) + result.pictures.size());
  std::int64_t tick = 0;
  for (const Block& block : result.servo) {
    for (const Period& period : block.periods) {
      AddTick(period, tick++, servo);
    }
  }
  trace::Track& sleeper = timeline.AddTrack("sleeper", PeriodsOf(result.sleeper));
  for (const Block& block : result.sleeper) {
    for (const Period& period : block.periods) {
      sleeper.Add({"wake-up", period.deadline_ns, period.deadline_ns + period.wake_ns, -1, Flow::kNone});
    }
  }
  trace::Track& camera = timeline.AddTrack("camera", 2 * result.pictures.size());
  trace::Track& vision = timeline.AddTrack("vision", result.pictures.size());
  for (std::size_t i = 0; i < result.pictures.size(); ++i) {
    const HopTimes& hop = result.pictures[i];
    const auto number = static_cast<std::int64_t>(i);
    const std::int64_t closed_ns = hop.stamp_ns + kExposureNs / 2;
    camera.Add({"exposure", hop.stamp_ns - kExposureNs / 2, closed_ns, number, Flow::kBegin});
    camera.Add({"read-out", closed_ns, closed_ns + kReadOutNs, number, Flow::kNone});
    if (hop.detected_ns > 0) {
      vision.Add({"detect", hop.arrived_ns, hop.detected_ns, number, Flow::kStep});
    }
    if (hop.written_ns > 0) {
      const std::int64_t begun_ns = std::max(hop.woken_ns, hop.detected_ns);
      servo.Add({"torque of a new picture", begun_ns, begun_ns, number, Flow::kEnd});
    }
  }
  timeline.Write(file);
}

}  // namespace fovea::bench
