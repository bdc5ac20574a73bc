// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/trace/tick_trace.hpp"

namespace fovea::trace {

void TickTrace::Enter() noexcept {
  probe_.Enter();
  picture_ = -1;
  begin_ns_ = last_ns_ = NowNs();
}

void TickTrace::MarkStageEnd(task::Stage stage) noexcept {
  const std::int64_t now_ns = NowNs();
  track_.Add({task::kStageNames[static_cast<std::size_t>(stage)], last_ns_, now_ns, -1, Flow::kNone});
  last_ns_ = now_ns;
}

void TickTrace::Record(const hal::TickRecord& record) noexcept {
  recorder_.Record(record);
  tick_ = static_cast<std::int64_t>(record.tick);
  picture_ = record.has_feature ? static_cast<std::int64_t>(record.feature.sequence) : -1;
}

void TickTrace::Leave() noexcept {
  const std::int64_t now_ns = NowNs();
  track_.Add({"write", last_ns_, now_ns, picture_, picture_ >= 0 ? Flow::kEnd : Flow::kNone});
  track_.Add({"tick", begin_ns_, now_ns, tick_, Flow::kNone});
  probe_.Leave();
}

hal::Status ClockTrace::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  const std::int64_t begin_ns = trace::NowNs();  // not the clock's own, which may be virtual
  const hal::Status status = clock_.WaitUntil(deadline_ns);
  track_.Add({name_, begin_ns, trace::NowNs(), -1, Flow::kNone});
  return status;
}

void SinkTrace::Put(const hal::FeatureMeasurement& measurement) noexcept {
  const std::int64_t now_ns = NowNs();
  track_.Add({"hand-over", now_ns, now_ns, static_cast<std::int64_t>(measurement.sequence), Flow::kStep});
  sink_.Put(measurement);
}

}  // namespace fovea::trace
