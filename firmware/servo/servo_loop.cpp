#include "fovea/servo/servo_loop.hpp"

#include <algorithm>

namespace fovea::servo {

ServoLoop::ServoLoop(ServoStep& task, hal::Arm& arm, hal::Clock& clock, hal::FeatureMailbox& features,
                     hal::Recorder& recorder, hal::TickProbe& probe) noexcept
    : task_(task), arm_(arm), clock_(clock), features_(features), recorder_(recorder), probe_(probe) {}

hal::Status ServoLoop::Run(std::int64_t end_ns) noexcept {
  return arm_.paces_loop() ? RunByArm(end_ns) : RunByClock(end_ns);
}

hal::Status ServoLoop::RunByClock(std::int64_t end_ns) noexcept {
  std::int64_t deadline_ns = clock_.NowNs();
  std::int32_t missed_ticks = 0;
  while (deadline_ns < end_ns && !stop_.load(std::memory_order_relaxed)) {
    probe_.Enter();
    inputs_.arm_status = arm_.Read(inputs_.arm);
    Tick(missed_ticks);
    probe_.Leave();
    deadline_ns += hal::kTickPeriodNs;
    if (const hal::Status status = clock_.WaitUntil(deadline_ns); !status.ok()) {
      return status;
    }
    // What was missed of the deadlines that there still were.
    const std::int64_t late = (clock_.NowNs() - deadline_ns) / hal::kTickPeriodNs;
    const std::int64_t left = (end_ns - deadline_ns + hal::kTickPeriodNs - 1) / hal::kTickPeriodNs;
    missed_ticks = static_cast<std::int32_t>(std::max<std::int64_t>(std::min(late, left), 0));
    CountMissed(missed_ticks);
    deadline_ns += missed_ticks * hal::kTickPeriodNs;
  }
  return hal::Status::Ok();
}

hal::Status ServoLoop::RunByArm(std::int64_t end_ns) noexcept {
  bool has_state = false;
  std::int64_t state_ns = 0;  // stamp of the arm's last state
  std::int64_t ticks_since = 0;
  while (clock_.NowNs() < end_ns && !stop_.load(std::memory_order_relaxed)) {
    // This is where the loop waits, so it is no part of the tick's time.
    inputs_.arm_status = arm_.Read(inputs_.arm);
    std::int32_t missed_ticks = 0;
    ++ticks_since;
    if (inputs_.arm_status.ok()) {
      const std::int64_t periods =
          (inputs_.arm.stamp_ns - state_ns + hal::kTickPeriodNs / 2) / hal::kTickPeriodNs;
      if (has_state) {
        missed_ticks =
            static_cast<std::int32_t>(std::clamp<std::int64_t>(periods - ticks_since, 0, INT32_MAX));
      }
      has_state = true;
      state_ns = inputs_.arm.stamp_ns;
      ticks_since = 0;
    }
    CountMissed(missed_ticks);
    probe_.Enter();
    Tick(missed_ticks);
    probe_.Leave();
    if (!inputs_.arm_status.ok() && inputs_.arm_status.code() != hal::StatusCode::kTimeout) {
      // An arm that is gone answers at once; its period is still the loop's.
      if (const hal::Status status = clock_.WaitUntil(clock_.NowNs() + hal::kTickPeriodNs); !status.ok()) {
        return status;
      }
    }
  }
  return hal::Status::Ok();
}

void ServoLoop::CountMissed(std::int32_t missed_ticks) noexcept {
  counters_.overruns += missed_ticks > 0 ? 1U : 0U;
  counters_.missed_ticks += static_cast<std::uint64_t>(missed_ticks);
}

void ServoLoop::Tick(std::int32_t missed_ticks) noexcept {
  inputs_.has_feature = features_.Take(inputs_.feature);
  inputs_.request = request_.exchange(Request::kNone, std::memory_order_relaxed);
  const int law = law_.exchange(-1, std::memory_order_relaxed);
  inputs_.change_law = law >= 0;
  if (inputs_.change_law) {
    inputs_.law = static_cast<MotionLawKind>(law);
  }
  if (motion_ != nullptr) {
    inputs_.motion = motion_->At(inputs_.arm.stamp_ns);
  }
  inputs_.missed_ticks = missed_ticks;
  task_.Step(inputs_, outputs_);
  const hal::Status written = arm_.Write(outputs_.command());
  recorder_.Record(outputs_.record);

  ++counters_.ticks;
  counters_.arm_read_errors += inputs_.arm_status.ok() ? 0U : 1U;
  counters_.arm_write_errors += written.ok() ? 0U : 1U;
}

}  // namespace fovea::servo
