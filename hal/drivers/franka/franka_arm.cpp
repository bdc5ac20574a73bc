// SPDX-License-Identifier: Apache-2.0
// The part that runs in the loop: no heap, no lock, no exception. The set-up is in franka_setup.cpp.
#include "fovea/franka/franka_arm.hpp"

#include <algorithm>

#include "fovea/franka/brake.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"

namespace fovea::franka {
namespace {

using hal::Status;
using hal::StatusCode;

// Largest drift between the robot's clock and the computer's: the estimate of their offset rises by this each
// millisecond.
constexpr std::int64_t kDriftNsPerState = 200;
constexpr std::int64_t kClockStepNs = 10 * hal::kNsPerMs;
constexpr int kClockStepStates = 1000;  // in a row
// After a read without a state, the next ones wait no longer than this: the loop stays responsive.
constexpr std::int64_t kSilentWaitNs = 100 * hal::kNsPerMs;
constexpr int kMostDatagramsPerRead = 256;
constexpr int kMostBrakingStates = 500;  // then the motion is finished, even if a joint still moves
constexpr std::uint64_t kMostMessageId = 1'000'000'000'000;  // 31 years of ms, which fit into 64 bits in ns
// States from before a recovery may arrive after its answer: UDP and TCP have no common order.
constexpr int kMostStoppedStates = 100;
constexpr int kMostStartingStates = 500;  // until the states must show a requested motion

hal::JointArray ToJoints(const Vector7& values) noexcept {
  hal::JointArray joints{};
  std::copy(values.begin(), values.end(), joints.begin());
  return joints;
}

}  // namespace

Status FrankaArm::DoRead(hal::ArmState& state) noexcept {
  if (recovery_asked_.exchange(false, std::memory_order_relaxed)) {
    Recover();
  }
  Answer(/*repeated=*/true);
  const std::int64_t patience_ns = silent_ ? std::min(state_timeout_ns_, kSilentWaitNs) : state_timeout_ns_;
  const std::int64_t deadline_ns = linux_rt::MonotonicNs() + patience_ns;
  for (;;) {
    const bool new_state = TakeStates();
    TakeAnswers();  // after the states: FollowPhase then knows all answers sent before the state
    if (!tcp_.open()) {
      return Status(StatusCode::kDisconnected, failure_);
    }
    if (new_state) {
      break;
    }
    const std::int64_t left_ns = deadline_ns - linux_rt::MonotonicNs();
    if (left_ns <= 0) {
      ++counters_.timeouts;
      silent_ = true;
      return Status(StatusCode::kTimeout, "robot state");
    }
    const std::array fds{udp_.fd(), tcp_.fd()};
    WaitReadable(fds, left_ns);
  }
  silent_ = false;
  FollowPhase();
  if (phase_ == MotionPhase::kFailed) {
    return Status(StatusCode::kDeviceFault, failure_);
  }
  Fill(state);
  return Status::Ok();
}

Status FrankaArm::DoWrite(const hal::ArmCommand& command) noexcept {
  if (!tcp_.open()) {
    return Status(StatusCode::kDisconnected, failure_);
  }
  std::copy_n(command.tau_cmd.begin(), tau_wish_.size(), tau_wish_.begin());
  brakes_ = command.engage_brakes;
  broken_off_ = broken_off_ && !brakes_;
  if (!brakes_ && !broken_off_ && phase_ == MotionPhase::kIdle && allow_motion_) {
    StartMotion();
  }
  Answer(/*repeated=*/false);
  return phase_ == MotionPhase::kFailed ? Status(StatusCode::kDeviceFault, failure_) : Status::Ok();
}

// Answers each state of a motion once.
void FrankaArm::Answer(bool repeated) noexcept {
  if (phase_ == MotionPhase::kRunning && brakes_) {
    phase_ = MotionPhase::kFinishing;
    braking_states_ = kMostBrakingStates;
  }
  if (answered_ || (phase_ != MotionPhase::kRunning && phase_ != MotionPhase::kFinishing)) {
    return;
  }
  answered_ = true;
  RobotCommand command;
  command.message_id = state_.message_id;
  command.q_c = state_.q_d;
  command.O_T_EE_c = state_.O_T_EE_d;
  command.elbow_c = state_.elbow_d;
  const bool brakes = phase_ == MotionPhase::kFinishing && braking_states_ > 0 && Moves(state_.dq);
  braking_states_ = brakes ? braking_states_ - 1 : 0;
  command.motion_generation_finished = phase_ == MotionPhase::kFinishing && !brakes ? 1 : 0;
  const bool limited =
      torque_rate_.Limit(brakes ? BrakingTorque(state_.dq) : tau_wish_, state_.tau_J_d, command.tau_J_d);
  ++counters_.commands;
  counters_.repeated_commands += repeated ? 1U : 0U;
  counters_.rate_limited += limited ? 1U : 0U;
  counters_.send_failures += udp_.Send(Bytes(command), robot_udp_) ? 0U : 1U;
}

void FrankaArm::StartMotion() noexcept {
  if (Post(Command::kMove, MoveRequest{}, move_id_)) {
    phase_ = MotionPhase::kStarting;
    torque_rate_.Clear();
    move_started_ = false;
    starting_states_ = 0;
    ++counters_.motions;
  }
}

void FrankaArm::Recover() noexcept {
  std::uint32_t id = 0;
  if (phase_ == MotionPhase::kFailed && !recovery_id_ &&
      Post(Command::kAutomaticErrorRecovery, Nothing{}, id)) {
    recovery_id_ = id;
  }
}

bool FrankaArm::PostBytes(std::span<const std::byte> message) noexcept {
  const bool sent = tcp_.Send(message);
  counters_.send_failures += sent ? 0U : 1U;
  return sent;
}

void FrankaArm::TakeAnswers() noexcept {
  Header header;
  std::span<const std::byte> payload;
  while (tcp_.open()) {
    switch (stream_.Take(tcp_, header, payload)) {
      case MessageStream::Next::kMessage: TakeAnswer(header, payload); break;
      case MessageStream::Next::kNothing: return;
      case MessageStream::Next::kClosed:
        Fail("the robot closed the connection");
        tcp_.Close();
        return;
      case MessageStream::Next::kGarbage:
        Fail("the robot sent an invalid message");
        tcp_.Close();
        return;
    }
  }
}

// Takes answers to posted requests; the set-up takes its own answers.
void FrankaArm::TakeAnswer(const Header& header, std::span<const std::byte> payload) noexcept {
  StatusAnswer answer;
  if (!Decode(payload, answer)) {
    return;
  }
  const bool under_way = phase_ == MotionPhase::kStarting || phase_ == MotionPhase::kRunning ||
                         phase_ == MotionPhase::kFinishing;
  if (header.command == Command::kMove && header.command_id == move_id_ && under_way) {
    switch (static_cast<MoveStatus>(answer.status)) {
      case MoveStatus::kMotionStarted: move_started_ = true; break;
      case MoveStatus::kSuccess: break;  // the states show it
      case MoveStatus::kPreempted: Fail("another motion replaced it"); break;
      case MoveStatus::kNotPossible: Fail("the robot cannot move now"); break;
      case MoveStatus::kStartAtSingularPose: Fail("the start pose is singular"); break;
      case MoveStatus::kInvalidArgument: Fail("the robot refuses the motion's arguments"); break;
      case MoveStatus::kEmergencyAborted: Fail("user stop"); break;
      default: Fail("the robot aborted the motion"); break;  // the state gives the reason
    }
  } else if (header.command == Command::kAutomaticErrorRecovery && recovery_id_ == header.command_id) {
    recovery_id_.reset();
    const auto status = static_cast<RecoveryStatus>(answer.status);
    if (status == RecoveryStatus::kSuccess) {
      phase_ = MotionPhase::kIdle;
      failure_ = "none";
      recovery_failure_ = nullptr;
      stopped_states_borne_ = kMostStoppedStates;
    } else {
      recovery_failure_ = status == RecoveryStatus::kManualRecoveryRequired
                              ? "the robot needs a person to recover it"
                              : "the robot cannot recover now";
      recovery_refusal_.store(recovery_failure_, std::memory_order_relaxed);
      Fail(recovery_failure_);
    }
  }
}

// Takes all waiting states and keeps the newest. False if none is new.
bool FrankaArm::TakeStates() noexcept {
  bool taken = false;
  std::array<std::byte, kStateSize + 1> bytes;  // one more, to detect a longer datagram
  std::size_t size = 0;
  Endpoint from;
  for (int k = 0; k < kMostDatagramsPerRead && udp_.Receive(bytes, size, from); ++k) {
    if (from.ip != robot_tcp_.ip) {
      ++counters_.foreign;
      continue;
    }
    RobotState next;
    if (size != kStateSize || !Decode(bytes, next) || next.message_id > kMostMessageId) {
      ++counters_.malformed;
      continue;
    }
    if (has_state_ && next.message_id <= state_.message_id) {
      ++(next.message_id == state_.message_id ? counters_.duplicate_states : counters_.late_states);
      continue;
    }
    counters_.lost_states += has_state_ ? next.message_id - state_.message_id - 1 : 0;
    counters_.skipped_states += taken ? 1U : 0U;
    ++counters_.states;
    state_ = next;
    has_state_ = true;
    robot_udp_ = from;
    stamp_ns_ = StampOf(next.message_id, linux_rt::MonotonicNs());
    taken = true;
    answered_ = false;
  }
  return taken;
}

// Converts the robot's time to the computer's. A datagram never arrives before it is sent, so the smallest
// difference seen is the best estimate. It rises a little with each state, because the clocks drift. If all
// states of a second arrive far later than it allows, the robot's clock was set or stood still.
std::int64_t FrankaArm::StampOf(std::uint64_t message_id, std::int64_t arrival_ns) noexcept {
  const std::int64_t robot_ns = static_cast<std::int64_t>(message_id) * hal::kNsPerMs;
  if (robot_time_ != nullptr) {
    robot_time_->Advance(robot_ns);
    return robot_ns;
  }
  const std::int64_t seen_ns = arrival_ns - robot_ns;
  robot_offset_ns_ = robot_offset_ns_ ? std::min(*robot_offset_ns_ + kDriftNsPerState, seen_ns) : seen_ns;
  if (seen_ns <= *robot_offset_ns_ + kClockStepNs) {
    late_states_ = {};
  } else {
    late_states_.least_ns = std::min(late_states_.least_ns, seen_ns);
    if (++late_states_.count == kClockStepStates) {
      robot_offset_ns_ = late_states_.least_ns;
      late_states_ = {};
    }
  }
  return std::max(stamp_ns_ + 1, robot_ns + *robot_offset_ns_);
}

// Updates phase_ from the newest state.
void FrankaArm::FollowPhase() noexcept {
  const bool moves = state_.robot_mode == RobotMode::kMove;
  const bool stopped =
      state_.robot_mode == RobotMode::kReflex || state_.robot_mode == RobotMode::kUserStopped;
  const bool borne = stopped && stopped_states_borne_ > 0;
  stopped_states_borne_ = borne ? stopped_states_borne_ - 1 : 0;
  if (stopped && !borne) {
    Fail(state_.robot_mode == RobotMode::kUserStopped ? "user stop"
         : recovery_failure_ != nullptr               ? recovery_failure_
                                                      : FirstError(state_.errors));
  } else if (phase_ == MotionPhase::kStarting && move_started_ && moves &&
             state_.controller_mode == ControllerMode::kExternal) {
    phase_ = MotionPhase::kRunning;
  } else if (phase_ == MotionPhase::kStarting && ++starting_states_ > kMostStartingStates) {
    Fail("the robot does not start the motion");
  } else if (phase_ == MotionPhase::kFinishing && !moves) {
    phase_ = MotionPhase::kIdle;
  } else if (phase_ == MotionPhase::kRunning && !moves) {
    Fail("the robot ended the motion");
  }
}

void FrankaArm::Fail(const char* why) noexcept {
  phase_ = MotionPhase::kFailed;
  broken_off_ = !brakes_;
  failure_ = why;
}

void FrankaArm::Fill(hal::ArmState& state) const noexcept {
  state.stamp_ns = stamp_ns_;
  state.sequence = state_.message_id;
  state.num_joints = kJoints;
  state.q = ToJoints(state_.q);
  state.dq = ToJoints(state_.dq);
  state.tau_meas = ToJoints(state_.tau_J);
  state.tau_applied = ToJoints(state_.tau_J_d);
}

void FrankaArm::Stop() noexcept {
  constexpr std::int64_t kPatienceNs = hal::kNsPerSecond;
  const std::int64_t end_ns = linux_rt::MonotonicNs() + kPatienceNs;
  silent_ = true;  // so that no read takes longer
  hal::ArmState ignored;
  while (tcp_.open() && linux_rt::MonotonicNs() < end_ns &&
         (phase_ == MotionPhase::kStarting || phase_ == MotionPhase::kRunning ||
          phase_ == MotionPhase::kFinishing)) {
    brakes_ = true;
    static_cast<void>(DoRead(ignored));  // phase_ shows the result
  }
  std::uint32_t id = 0;
  if (tcp_.open() && phase_ != MotionPhase::kIdle && phase_ != MotionPhase::kFailed) {
    static_cast<void>(Post(Command::kStopMove, Nothing{}, id));  // closing ends the motion in any case
  }
  tcp_.Close();
}

}  // namespace fovea::franka
