// SPDX-License-Identifier: Apache-2.0
#include "sim/mcu/board_servo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

namespace fovea::sim {
namespace {

constexpr int kHelloTimeoutMs = 1'000;  // wait for the board's hello before the host asks for one
constexpr int kHelloAttempts = 20;
constexpr int kConfigureTimeoutMs = 20'000;
constexpr int kAnswerTimeoutMs = 2'000;
constexpr int kAttempts = 10;          // frames may be damaged; the board steps once for repeated frames
constexpr double kTimerPeriodNs = 40;  // of the board's counter, 25 MHz
constexpr double kTickSeconds = 1e-9 * static_cast<double>(hal::kTickPeriodNs);
constexpr double kRounding = 1.0 + 1e-9;  // tolerance: a step of exactly the limit stays bit-equal
constexpr std::uint64_t kWayBack = 1;     // the way back has its own random seed

const char* NameOfException(std::uint32_t number) {
  switch (number) {
    case 3: return "hard fault";
    case 4: return "memory management fault";
    case 5: return "bus fault";
    case 6: return "usage fault";
    default: return "unexpected interrupt";
  }
}

}  // namespace

BoardServo::BoardServo(std::unique_ptr<BoardLine> line, const BoardConfig& config, std::uint64_t seed,
                       const config::ServoConfig& servo, const model::Load& load)
    : line_(std::move(line)),
      config_(config),
      torque_lost_ns_(servo.safety.arm_lost_ticks * hal::kTickPeriodNs),
      up_({}, seed),
      down_({}, seed + kWayBack) {
  in_force_.command.num_joints = servo.arm.num_joints;
  in_force_.command.engage_brakes = true;
  for (int i = 0; i < servo.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    torque_step_[k] = servo.arm.joints[k].dtau_max * kTickSeconds * kRounding;
  }
  Start(servo, load);
}

void BoardServo::Start(const config::ServoConfig& servo, const model::Load& load) {
  for (int attempt = 0; !Await(link::FrameKind::kHello, 0, kHelloTimeoutMs); ++attempt) {
    if (attempt == kHelloAttempts || !line_->Send(writer_.Encode({link::FrameKind::kHello, 0, {}}))) {
      throw std::runtime_error(failure_.empty() ? "the servo's board does not start" : failure_);
    }
  }
  link::Configuration configuration;
  configuration.pacing = config_.by_timer ? link::Pacing::kGated : link::Pacing::kLockstep;
  configuration.arm_crc = link::ArmCrc(servo.arm);
  configuration.load = load;
  configuration.servo = servo;
  static_cast<void>(
      line_->Send(writer_.Encode({link::FrameKind::kConfigure, 0, link::Encode(configuration, payload_)})));
  link::Answer answer;
  if (!Await(link::FrameKind::kAnswer, 0, kConfigureTimeoutMs) ||
      !link::Decode(reader_.frame().payload, answer)) {
    throw std::runtime_error(failure_.empty() ? "the servo's board does not answer to its configuration"
                                              : failure_);
  }
  if (answer.code != hal::StatusCode::kOk) {
    const bool arm = std::string(answer.where.data()) == "arm";
    throw std::runtime_error(fmt::format("the servo's board refuses its configuration: {} ({}{})",
                                         hal::ToString(answer.code), answer.where.data(),
                                         arm ? ": its image holds the shipped panda" : ""));
  }
}

void BoardServo::Step(const task::ServoInputs& inputs, task::ServoOutputs& outputs) noexcept {
  now_ns_ += (1 + inputs.missed_ticks) * hal::kTickPeriodNs;
  const bool ticked =
      failure_.empty() && (config_.by_timer ? ExchangeByTimer(inputs) : [&] {
        ++sequence_;
        return Exchange({link::FrameKind::kInputs, sequence_, link::Encode(inputs, payload_)});
      }());
  if (ticked) {
    outputs.record = answer_.record;
    figures_.Add(answer_);
  } else {
    outputs.record = hal::TickRecord{};
    outputs.record.stamp_ns = inputs.arm.stamp_ns;
    outputs.record.mode = hal::Mode::kFault;
  }
  if (config_.by_timer && ticked) {
    TakeTorque();
    outputs.record.command = in_force_.command;
  }
  if (!failure_.empty() || !stopped_.empty()) {
    outputs.record.command = hal::ArmCommand{};
    outputs.record.command.state_sequence = inputs.arm.sequence;
    outputs.record.command.num_joints = inputs.arm.num_joints;
    outputs.record.command.engage_brakes = true;
  }
  outputs.record.arm = inputs.arm;
  outputs.record.has_feature = inputs.has_feature;
  outputs.record.feature = inputs.feature;
}

// Sends `frame` and waits. True if `answer_` holds the answer to it.
bool BoardServo::Exchange(const link::Frame& frame) {
  const std::span<const std::uint8_t> bytes = writer_.Encode(frame);
  for (int attempt = 0; attempt < kAttempts && failure_.empty(); ++attempt) {
    frames_sent_again_ += attempt > 0 ? 1U : 0U;
    if (line_->Send(bytes) && Await(link::FrameKind::kOutputs, frame.sequence, kAnswerTimeoutMs) &&
        link::Decode(reader_.frame().payload, answer_)) {
      return true;
    }
    if (line_->gone()) {
      failure_ = "the servo's board is gone";
    }
  }
  if (failure_.empty()) {
    failure_ = "the servo's board does not answer any more";
  }
  return false;
}

// Puts the state on the line. Sends the board the states that have arrived, and runs its timer to the next
// tick.
bool BoardServo::ExchangeByTimer(const task::ServoInputs& inputs) {
  ++sequence_;
  if (static_cast<double>(now_ns_ - hal::kTickPeriodNs) >= config_.line_from_s * 1e9) {
    up_.SetFaults(config_.line);
    down_.SetFaults(config_.line);
  }
  up_.Put({sequence_, inputs}, now_ns_);
  while (const std::optional<Up> came = up_.Take(now_ns_)) {
    static_cast<void>(line_->Send(
        writer_.Encode({link::FrameKind::kInputs, came->sequence, link::Encode(came->inputs, payload_)})));
  }
  if (!Exchange({link::FrameKind::kGo, sequence_, {}})) {
    return false;
  }
  down_.Put({sequence_, answer_.record.command}, now_ns_ + answer_.periods_passed * hal::kTickPeriodNs);
  return true;
}

// Takes the newest torque that has arrived. Without one, holds the last torque for a limited time.
void BoardServo::TakeTorque() {
  bool any = false;
  const hal::ArmCommand before = in_force_.command;
  while (const std::optional<Down> came = down_.Take(now_ns_)) {
    if (came->sequence > in_force_.sequence) {
      in_force_ = *came;
      torque_ns_ = now_ns_;
      any = true;
    }
  }
  ticks_without_torque_ += any ? 0U : 1U;
  // After a lost torque, the next one may differ by two steps: limit it to one.
  for (std::size_t i = 0; i < torque_step_.size(); ++i) {
    double& torque = in_force_.command.tau_cmd[i];
    torque = std::clamp(torque, before.tau_cmd[i] - torque_step_[i], before.tau_cmd[i] + torque_step_[i]);
  }
  if (stopped_.empty() && now_ns_ - torque_ns_ >= torque_lost_ns_) {
    stopped_ = fmt::format("no torque came from the servo's board for {} ms",
                           (now_ns_ - torque_ns_) / hal::kTickPeriodNs);
  }
}

std::int64_t BoardServo::OverrunNs() const noexcept {
  const std::uint32_t passed = answer_.periods_passed;
  return passed > 1 ? (passed - 1) * hal::kTickPeriodNs : 0;
}

// Waits for such a frame. True if `reader_` holds it.
bool BoardServo::Await(link::FrameKind kind, std::uint32_t sequence, int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  while (failure_.empty() && !line_->gone()) {
    while (!left_.empty()) {
      const std::uint8_t byte = left_.front();
      left_ = left_.subspan(1);
      if (!reader_.Add(byte)) {
        continue;
      }
      if (reader_.frame().kind == link::FrameKind::kCrash) {
        NoteCrash();
        return false;
      }
      if (reader_.frame().kind == kind && reader_.frame().sequence == sequence) {
        return true;
      }
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      return false;
    }
    left_ = line_->Receive(received_, static_cast<int>(left.count()));
  }
  return false;
}

void BoardServo::NoteCrash() {
  link::Crash crash;
  failure_ = link::Decode(reader_.frame().payload, crash)
                 ? fmt::format("the servo's processor took a {} (pc {:#010x}, lr {:#010x}, CFSR {:#010x})",
                               NameOfException(crash.exception), crash.pc, crash.lr, crash.cfsr)
                 : "the servo's processor took a fault";
}

BoardSummary BoardServo::Summarise() const {
  BoardSummary summary;
  summary.by_timer = config_.by_timer;
  summary.instruction_ns = config_.instruction_ns;
  summary.frames_sent_again = frames_sent_again_;
  summary.ticks_without_torque = ticks_without_torque_;
  summary.stopped = stopped_;
  figures_.Fill(kTimerPeriodNs / config_.instruction_ns, summary);
  return summary;
}

}  // namespace fovea::sim
