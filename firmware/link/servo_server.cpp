#include "fovea/link/servo_server.hpp"

namespace fovea::link {

template <class Message>
void ServoServer::Send(FrameKind kind, std::uint32_t sequence, const Message& message) noexcept {
  board_.Send(writer_.Encode({kind, sequence, Encode(message, payload_)}));
}

void ServoServer::SayHello() noexcept { board_.Send(writer_.Encode({FrameKind::kHello, 0, {}})); }

void ServoServer::Receive(std::uint8_t byte) noexcept {
  if (reader_.Add(byte)) {
    Take(reader_.frame());
  }
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
    case FrameKind::kHello: SayHello(); return;  // the host came late, or anew
    default: return;                             // what only the servo sends
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
  if (status.ok()) {
    task_.UseProbe(this);
    inputs_ = servo::ServoInputs{};
    fresh_ = false;
    answered_ = false;
    silent_ticks_ = 0;
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
  const bool again = frame.sequence == sequence_;
  if (configuration_.pacing == Pacing::kLockstep) {
    if (again && answered_) {
      Send(FrameKind::kOutputs, sequence_, sent_);
    } else if (Decode(frame.payload, inputs_)) {
      Step(frame.sequence);
    }
    return;
  }
  // By the timer: a frame that is late is overtaken by the next, but what it asked for and saw is not lost.
  received_ = servo::ServoInputs{};
  const bool newer = !answered_ || static_cast<std::int32_t>(frame.sequence - sequence_) > 0;
  if (!newer || !Decode(frame.payload, received_)) {
    return;
  }
  if (fresh_) {
    if (!received_.has_feature && inputs_.has_feature) {
      received_.has_feature = true;
      received_.feature = inputs_.feature;
    }
    if (received_.request == servo::Request::kNone) {
      received_.request = inputs_.request;
    }
    if (!received_.change_law && inputs_.change_law) {
      received_.change_law = true;
      received_.law = inputs_.law;
    }
  }
  inputs_ = received_;
  sequence_ = frame.sequence;
  answered_ = true;
  fresh_ = true;
}

void ServoServer::TickByTimer(std::int32_t missed_ticks) noexcept {
  if (!TicksByTimer()) {
    return;
  }
  if (!fresh_) {
    ++silent_ticks_;
    inputs_.arm_status = hal::Status(hal::StatusCode::kTimeout, "link");
    inputs_.has_feature = false;
    inputs_.request = servo::Request::kNone;
    inputs_.motion = servo::MotionCommand{};
    inputs_.change_law = false;
  }
  fresh_ = false;
  inputs_.missed_ticks = missed_ticks;
  Step(sequence_);
}

void ServoServer::Step(std::uint32_t sequence) noexcept {
  sent_ = Outputs{};
  const std::uint32_t began = board_.TimerCounts();
  stage_began_ = began;
  task_.Step(inputs_, outputs_);
  sent_.tick_counts = board_.TimerCounts() - began;
  sent_.record = outputs_.record;
  sent_.stack_bytes = board_.StackBytes();
  sent_.damaged_frames = reader_.counters().damaged;
  sent_.silent_ticks = silent_ticks_;
  sequence_ = sequence;
  answered_ = true;
  Send(FrameKind::kOutputs, sequence, sent_);
}

void ServoServer::Done(servo::Stage stage) noexcept {
  const std::uint32_t now = board_.TimerCounts();
  sent_.stage_counts[static_cast<std::size_t>(stage)] += now - stage_began_;
  stage_began_ = now;
}

}  // namespace fovea::link
