// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/link/servo_server.hpp"

#include <algorithm>

namespace fovea::link {
namespace {

constexpr std::int64_t kDriftNs = hal::kTickPeriodNs / 10'000;  // in a tick, between two clocks: 100 ppm

// Stamps come from the other end. The difference wraps instead of overflowing.
std::int64_t Difference(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

}  // namespace

template <class Message>
void ServoServer::Send(FrameKind kind, std::uint32_t sequence, const Message& message) noexcept {
  board_.Send(writer_.Encode({kind, sequence, Encode(message, payload_)}));
}

void ServoServer::SayHello() noexcept { board_.Send(writer_.Encode({FrameKind::kHello, 0, {}})); }

void ServoServer::Receive(std::span<const std::uint8_t> bytes) noexcept {
  // The time of a tick that an Inputs frame causes is not the link's time.
  std::uint32_t began = board_.TimerCounts();
  for (const std::uint8_t byte : bytes) {
    if (reader_.Add(byte)) {
      link_counts_ += board_.TimerCounts() - began;
      Take(reader_.frame());
      began = board_.TimerCounts();
    }
  }
  link_counts_ += board_.TimerCounts() - began;
}

void ServoServer::Take(const Frame& frame) noexcept {
  switch (frame.kind) {
    case FrameKind::kConfigure: Configure(frame); return;
    case FrameKind::kInputs: TakeInputs(frame); return;
    case FrameKind::kProvoke:
      if (Provocation what{}; configured_ && configuration_.may_provoke && Decode(frame.payload, what)) {
        board_.Provoke(what);
      }
      return;
    case FrameKind::kGo: LetTimerRun(frame); return;
    case FrameKind::kHello: SayHello(); return;  // the host started late or again
    default: return;                             // only the servo sends these
  }
}

void ServoServer::Configure(const Frame& frame) noexcept {
  configured_ = false;
  hal::Status status(hal::StatusCode::kInvalidArgument, "configuration");
  if (Decode(frame.payload, configuration_)) {
    configuration_.servo.arm = arm_;
    if (configuration_.load.mass > 0.0) {
      model::Attach(configuration_.load, configuration_.servo.arm);
    }
    status = ArmCrc(configuration_.servo.arm) == configuration_.arm_crc
                 ? task_.Init(configuration_.servo)
                 : hal::Status(hal::StatusCode::kInvalidArgument, "arm");
  }
  board_.RunTimer(false);
  if (status.ok()) {
    task_.UseProbe(this);
    inputs_ = task::ServoInputs{};
    answered_ = false;
    fresh_ = false;
    requests_.Clear();
    has_inputs_ = false;
    time_ns_ = 0;
    least_lag_ns_ = 0;
    line_ = LineCounters{};
    link_counts_ = 0;
    damaged_before_ = reader_.counters().damaged;
    periods_done_ = board_.Periods();
    may_tick_ = configuration_.pacing == Pacing::kTimer;
    board_.RunTimer(may_tick_);
    configured_ = true;
  }
  Answer answer;
  answer.code = status.code();
  for (std::size_t i = 0; i + 1 < Answer::kWhere && status.where()[i] != '\0'; ++i) {
    answer.where[i] = status.where()[i];
  }
  Send(FrameKind::kAnswer, frame.sequence, answer);
}

void ServoServer::TakeInputs(const Frame& frame) noexcept {
  if (!configured_) {
    return;
  }
  if (configuration_.pacing != Pacing::kLockstep) {
    TakeInputsByTimer(frame);
    return;
  }
  if (answered_ && frame.sequence == sequence_) {
    Send(FrameKind::kOutputs, sequence_, sent_);
    return;
  }
  const std::uint32_t began = board_.TimerCounts();
  const bool whole = Decode(frame.payload, inputs_);
  link_counts_ += board_.TimerCounts() - began;
  if (whole) {
    sequence_ = frame.sequence;
    Step();
  }
}

// With the timer: the next frame overtakes a late one, but its request and measurement are kept. Of a frame
// that comes too late, only a Hold counts.
void ServoServer::TakeInputsByTimer(const Frame& frame) noexcept {
  const bool newer = !has_inputs_ || static_cast<std::int32_t>(frame.sequence - inputs_sequence_) > 0;
  const std::uint32_t began = board_.TimerCounts();
  received_ = task::ServoInputs{};
  const bool whole = Decode(frame.payload, received_);
  link_counts_ += board_.TimerCounts() - began;
  const bool late = !newer || (whole && ComesTooLate(received_.arm.stamp_ns));
  line_.late_frames += late ? 1U : 0U;
  if (whole && late && received_.request == task::Request::kHold) {
    requests_.Put(task::Request::kHold);
  }
  if (!whole || late) {
    return;
  }
  if (fresh_) {
    if (!received_.has_feature && inputs_.has_feature) {
      received_.has_feature = true;
      received_.feature = inputs_.feature;
    }
    if (!received_.change_law && inputs_.change_law) {
      received_.change_law = true;
      received_.law = inputs_.law;
    }
    if (!received_.tuning.IsAsked()) {
      received_.tuning = inputs_.tuning;
    }
    if (!received_.plan.IsThere()) {
      received_.plan = inputs_.plan;
    }
  }
  if (received_.request != task::Request::kNone) {
    requests_.Put(received_.request);
  }
  inputs_ = received_;
  inputs_sequence_ = frame.sequence;
  has_inputs_ = true;
  fresh_ = true;
}

// The two ends have no common clock: a state's delay is measured relative to the quickest state. A state as
// late as an arm may be silent counts as lost.
bool ServoServer::ComesTooLate(std::int64_t stamp_ns) noexcept {
  const std::int64_t lag_ns = Difference(time_ns_, stamp_ns);
  least_lag_ns_ = has_inputs_ ? std::min(least_lag_ns_, lag_ns) : lag_ns;
  return Difference(lag_ns, least_lag_ns_) >= configuration_.servo.safety.arm_lost_ticks * hal::kTickPeriodNs;
}

void ServoServer::LetTimerRun(const Frame& frame) noexcept {
  if (!configured_ || configuration_.pacing != Pacing::kGated || may_tick_) {
    return;
  }
  if (answered_ && frame.sequence == sequence_) {
    Send(FrameKind::kOutputs, sequence_, sent_);
    return;
  }
  sequence_ = frame.sequence;
  may_tick_ = true;
  board_.RunTimer(true);
}

void ServoServer::Poll() noexcept {
  if (!configured_ || !may_tick_) {
    return;
  }
  if (const std::uint32_t due = board_.Periods() - periods_done_; due > 0) {
    periods_done_ += due;
    time_ns_ += due * hal::kTickPeriodNs;
    least_lag_ns_ = has_inputs_ ? Difference(least_lag_ns_, -(due * kDriftNs)) : 0;
    TickByTimer(static_cast<std::int32_t>(due - 1));
  }
}

void ServoServer::TickByTimer(std::int32_t missed_ticks) noexcept {
  if (!fresh_) {
    ++line_.silent_ticks;
    inputs_.arm_status = hal::Status(hal::StatusCode::kTimeout, "link");
    inputs_.has_feature = false;
    inputs_.motion = moves::MotionCommand{};
    inputs_.change_law = false;
    inputs_.tuning = {};
    inputs_.plan = {};
  }
  inputs_.request = requests_.Take();
  fresh_ = false;
  inputs_.missed_ticks = missed_ticks;
  line_.missed_ticks += static_cast<std::uint32_t>(missed_ticks);
  if (configuration_.pacing == Pacing::kTimer) {
    sequence_ = inputs_sequence_;
  }
  Step();
}

LineCounters ServoServer::Counters() noexcept {
  const LineLosses lost = board_.Lost();
  LineCounters counters = line_;
  counters.damaged_frames = reader_.counters().damaged - damaged_before_;
  counters.lost_bytes = lost.bytes;
  counters.unsent_frames = lost.frames;
  return counters;
}

void ServoServer::Step() noexcept {
  sent_ = Outputs{};
  const std::uint32_t began = board_.TimerCounts();
  stage_began_ = began;
  task_.Step(inputs_, outputs_);
  sent_.tick_counts = board_.TimerCounts() - began;
  if (configuration_.pacing == Pacing::kGated) {
    board_.RunTimer(false);
    may_tick_ = false;
  }
  if (configuration_.pacing != Pacing::kLockstep) {
    sent_.periods_passed = board_.Periods() - periods_done_;
  }
  sent_.record = outputs_.record;
  sent_.link_counts = link_counts_;
  sent_.stack_bytes = board_.StackBytes();
  sent_.line = Counters();
  answered_ = true;
  const std::uint32_t sends = board_.TimerCounts();
  Send(FrameKind::kOutputs, sequence_, sent_);
  link_counts_ = board_.TimerCounts() - sends;
}

void ServoServer::MarkStageEnd(task::Stage stage) noexcept {
  const std::uint32_t now = board_.TimerCounts();
  sent_.stage_counts[static_cast<std::size_t>(stage)] += now - stage_began_;
  stage_began_ = now;
}

}  // namespace fovea::link
