#include "sim/mcu/board_servo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace fovea::sim {
namespace {

constexpr int kHelloTimeoutMs = 1'000;  // until it is asked whether it is there
constexpr int kHelloAttempts = 20;
constexpr int kConfigureTimeoutMs = 20'000;
constexpr std::size_t kManyTicks = 1'000'000;  // room for their figures: the loop is not to wait for memory
constexpr int kAnswerTimeoutMs = 2'000;
constexpr int kAttempts = 10;          // frames may be damaged; the board steps once however often one comes
constexpr double kTimerPeriodNs = 40;  // of the board's counter, 25 MHz

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

BoardServo::BoardServo(const QemuConfig& qemu, const servo::ServoConfig& config, const model::Load& load)
    : qemu_(qemu), instructions_per_count_(kTimerPeriodNs / std::exp2(qemu.instruction_shift)) {
  for (int attempt = 0; !Await(link::FrameKind::kHello, 0, kHelloTimeoutMs); ++attempt) {
    if (attempt == kHelloAttempts || !qemu_.Send(writer_.Encode({link::FrameKind::kHello, 0, {}}))) {
      throw std::runtime_error(failure_.empty() ? "the servo's board does not start" : failure_);
    }
  }
  tick_counts_.reserve(kManyTicks);
  link::Configuration configuration;
  configuration.arm_crc = link::ArmCrc(config.arm);
  configuration.load = load;
  configuration.servo = config;
  static_cast<void>(
      qemu_.Send(writer_.Encode({link::FrameKind::kConfigure, 0, link::Encode(configuration, payload_)})));
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

void BoardServo::Step(const servo::ServoInputs& inputs, servo::ServoOutputs& outputs) noexcept {
  if (failure_.empty() && Exchange(inputs)) {
    outputs.record = answer_.record;
    NoteFigures();
  } else {
    outputs.record = hal::TickRecord{};
    outputs.record.stamp_ns = inputs.arm.stamp_ns;
    outputs.record.mode = hal::Mode::kFault;
    outputs.record.command.state_sequence = inputs.arm.sequence;
    outputs.record.command.num_joints = inputs.arm.num_joints;
    outputs.record.command.engage_brakes = true;
  }
  outputs.record.arm = inputs.arm;
  outputs.record.has_feature = inputs.has_feature;
  outputs.record.feature = inputs.feature;
}

bool BoardServo::Exchange(const servo::ServoInputs& inputs) {
  ++sequence_;
  const std::span<const std::uint8_t> frame =
      writer_.Encode({link::FrameKind::kInputs, sequence_, link::Encode(inputs, payload_)});
  for (int attempt = 0; attempt < kAttempts && failure_.empty(); ++attempt) {
    frames_sent_again_ += attempt > 0 ? 1U : 0U;
    if (qemu_.Send(frame) && Await(link::FrameKind::kOutputs, sequence_, kAnswerTimeoutMs) &&
        link::Decode(reader_.frame().payload, answer_)) {
      return true;
    }
    if (qemu_.gone()) {
      failure_ = "the servo's board is gone";
    }
  }
  if (failure_.empty()) {
    failure_ = "the servo's board answers no more";
  }
  return false;
}

// True with such a frame in the reader.
bool BoardServo::Await(link::FrameKind kind, std::uint32_t sequence, int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  while (failure_.empty() && !qemu_.gone()) {
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
    left_ = qemu_.Receive(received_, static_cast<int>(left.count()));
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

void BoardServo::NoteFigures() {
  tick_counts_.push_back(answer_.tick_counts);
  for (std::size_t i = 0; i < link::kNumStages; ++i) {
    stage_counts_[i] += answer_.stage_counts[i];
  }
  stack_bytes_ = std::max(stack_bytes_, answer_.stack_bytes);
}

BoardSummary BoardServo::Summarise() const {
  BoardSummary summary;
  summary.stack_bytes = stack_bytes_;
  summary.frames_sent_again = frames_sent_again_;
  if (tick_counts_.empty()) {
    return summary;
  }
  std::vector<std::uint32_t> sorted = tick_counts_;
  std::sort(sorted.begin(), sorted.end());
  const auto instructions = [&](std::uint32_t counts) {
    return static_cast<std::uint32_t>(std::lround(counts * instructions_per_count_));
  };
  summary.tick_instructions_min = instructions(sorted.front());
  summary.tick_instructions_p50 = instructions(sorted[sorted.size() / 2]);
  summary.tick_instructions_max = instructions(sorted.back());
  for (std::size_t i = 0; i < link::kNumStages; ++i) {
    summary.stage_instructions.emplace_back(
        servo::kStageNames[i],
        static_cast<double>(stage_counts_[i]) * instructions_per_count_ / static_cast<double>(sorted.size()));
  }
  return summary;
}

}  // namespace fovea::sim
