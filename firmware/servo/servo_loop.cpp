#include "fovea/servo/servo_loop.hpp"

namespace fovea::servo {

ServoLoop::ServoLoop(ServoTask& task, hal::Arm& arm, hal::Clock& clock, hal::FeatureMailbox& features,
                     hal::Recorder& recorder, hal::TickProbe& probe) noexcept
    : task_(task), arm_(arm), clock_(clock), features_(features), recorder_(recorder), probe_(probe) {}

hal::Status ServoLoop::Run(std::int64_t end_ns) noexcept {
  std::int64_t deadline_ns = clock_.NowNs();
  std::int32_t missed_ticks = 0;
  while (deadline_ns < end_ns && !stop_.load(std::memory_order_relaxed)) {
    Tick(missed_ticks);
    deadline_ns += hal::kTickPeriodNs;
    if (!arm_.paces_loop()) {
      if (const hal::Status status = clock_.WaitUntil(deadline_ns); !status.ok()) {
        return status;
      }
    }
    const std::int64_t late_ns = clock_.NowNs() - deadline_ns;
    missed_ticks = late_ns > 0 ? static_cast<std::int32_t>(late_ns / hal::kTickPeriodNs) : 0;
    if (missed_ticks > 0) {
      ++counters_.overruns;
      counters_.missed_ticks += static_cast<std::uint64_t>(missed_ticks);
      deadline_ns += missed_ticks * hal::kTickPeriodNs;
    }
  }
  return hal::Status::Ok();
}

void ServoLoop::Tick(std::int32_t missed_ticks) noexcept {
  probe_.Enter();
  inputs_.arm_status = arm_.Read(inputs_.arm);
  inputs_.has_feature = features_.Take(inputs_.feature);
  inputs_.request = request_.exchange(Request::kNone, std::memory_order_relaxed);
  inputs_.missed_ticks = missed_ticks;
  task_.Step(inputs_, outputs_);
  const hal::Status written = arm_.Write(outputs_.command());
  recorder_.Record(outputs_.record);
  probe_.Leave();

  ++counters_.ticks;
  counters_.arm_read_errors += inputs_.arm_status.ok() ? 0U : 1U;
  counters_.arm_write_errors += written.ok() ? 0U : 1U;
}

}  // namespace fovea::servo
