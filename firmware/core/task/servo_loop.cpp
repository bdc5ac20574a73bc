// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/servo_loop.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::task {
namespace {

constexpr double kReferenceRests = 1e-3;  // every joint of the reference slower than this [rad/s, m/s]
constexpr double kArmRests = 0.02;        // and every joint of the arm than this
constexpr int kMostFinishingTicks = 2000;

bool IsSlow(const hal::JointArray& dq, double limit) noexcept {
  return std::all_of(dq.begin(), dq.end(), [limit](double speed) { return std::fabs(speed) < limit; });
}

}  // namespace

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
    if (HasFinished()) {
      break;
    }
    deadline_ns += hal::kTickPeriodNs;
    if (const hal::Status status = clock_.WaitUntil(deadline_ns); !status.ok()) {
      return status;
    }
    // The number of missed deadlines, at most those before end_ns.
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
  std::int64_t state_ns = 0;               // stamp of the arm's last state
  std::int64_t heard_ns = clock_.NowNs();  // when it came; before the first: the start
  std::int64_t ticks_since = 0;            // run or missed
  while (clock_.NowNs() < end_ns && !stop_.load(std::memory_order_relaxed)) {
    // The loop waits here, so that this is not part of the tick's time.
    inputs_.arm_status = arm_.Read(inputs_.arm);
    const bool answered = inputs_.arm_status.ok();
    // Since the last state: by stamps; while the arm is silent, by the clock.
    std::int64_t periods = 0;
    if (!answered) {
      periods = (clock_.NowNs() - heard_ns) / hal::kTickPeriodNs;
    } else if (has_state) {
      periods = (inputs_.arm.stamp_ns - state_ns + hal::kTickPeriodNs / 2) / hal::kTickPeriodNs;
    }
    ++ticks_since;
    const auto missed_ticks =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(periods - ticks_since, 0, INT32_MAX));
    ticks_since += missed_ticks;
    if (answered) {
      has_state = true;
      state_ns = inputs_.arm.stamp_ns;
      heard_ns = clock_.NowNs();
      ticks_since = 0;
    }
    CountMissed(missed_ticks);
    probe_.Enter();
    Tick(missed_ticks);
    probe_.Leave();
    if (HasFinished()) {
      break;
    }
    if (!answered && inputs_.arm_status.code() != hal::StatusCode::kTimeout) {
      // A lost arm answers at once; the loop still keeps its period.
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

// True if this tick may get requests for motion.
bool ServoLoop::MayMove() noexcept {
  const std::int64_t until_ns = leave_until_ns_.load(std::memory_order_relaxed);
  const bool ended = until_ns != kForEver && clock_.NowNs() >= until_ns;
  if (ended && !leave_ended_) {
    lease_ends_.fetch_add(1, std::memory_order_relaxed);
  }
  leave_ended_ = ended;
  const bool finishes = finish_.load(std::memory_order_relaxed);
  if (finishes && finishing_ticks_++ == 0) {
    finish_tick_.store(counters_.ticks, std::memory_order_release);
  }
  return !ended && !finishes;
}

// True if a run that should finish may end after the last tick.
bool ServoLoop::HasFinished() noexcept {
  if (finishing_ticks_ == 0) {
    return false;
  }
  const hal::TickRecord& record = outputs_.record;
  const bool answered = inputs_.arm_status.ok();  // an old state does not show that the arm rests
  silent_ticks_ = answered ? 0 : silent_ticks_ + 1;
  const bool reference_rests = record.mode == hal::Mode::kBoot || IsSlow(record.dq_cmd, kReferenceRests);
  const bool rests =
      answered && record.mode != hal::Mode::kFault && reference_rests && IsSlow(record.arm.dq, kArmRests);
  return rests || record.command.engage_brakes || silent_ticks_ >= kMostSilentTicks ||
         finishing_ticks_ >= kMostFinishingTicks;
}

LoopCounters ServoLoop::counters() const noexcept {
  LoopCounters counters = counters_;
  counters.lease_ends = lease_ends();
  return counters;
}

void ServoLoop::Tick(std::int32_t missed_ticks) noexcept {
  inputs_.has_feature = features_.Take(inputs_.feature);
  inputs_.request = requests_.Take();
  const int law = law_.exchange(-1, std::memory_order_relaxed);
  inputs_.change_law = law >= 0;
  if (inputs_.change_law) {
    inputs_.law = static_cast<config::MotionLawKind>(law);
  }
  inputs_.tuning = tunings_.Take();
  const bool may_move = MayMove();
  if (!may_move && (inputs_.request != Request::kReset || finishing_ticks_ > 0)) {
    inputs_.request = Request::kHold;
  }
  if (motion_ != nullptr) {
    inputs_.motion = motion_->At(inputs_.arm.stamp_ns);
    motion_barred_ = !may_move || (motion_barred_ && inputs_.motion.kind != moves::MotionKind::kNone);
    if (motion_barred_) {
      inputs_.motion = moves::MotionCommand{};
    }
  }
  inputs_.plan = planner_.Next();
  inputs_.missed_ticks = missed_ticks;
  task_.Step(inputs_, outputs_);
  const hal::Status written = arm_.Write(outputs_.command());
  recorder_.Record(outputs_.record);
  planner_.Note(outputs_.record);

  ++counters_.ticks;
  counters_.arm_read_errors += inputs_.arm_status.ok() ? 0U : 1U;
  counters_.arm_write_errors += written.ok() ? 0U : 1U;
}

}  // namespace fovea::task
