// SPDX-License-Identifier: Apache-2.0
// The host's end of the link: a board that sends arbitrary answers. Every tick
// ends; after the board has failed the brakes are engaged.
#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "sim/mcu/board_servo.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/panda.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

// Sends hello and the configuration answer, then frames made from the input; gone at the input's end.
class AnyBoard final : public sim::BoardLine {
 public:
  explicit AnyBoard(fuzz::Bytes& input) : input_(input) { Put(link::FrameKind::kHello, 0, {}); }

  bool Send(std::span<const std::uint8_t> bytes) noexcept override {
    for (const std::uint8_t byte : bytes) {
      if (reader_.Add(byte)) {
        asked_ = reader_.frame().sequence;
        if (reader_.frame().kind == link::FrameKind::kConfigure) {
          Put(link::FrameKind::kAnswer, asked_, link::Encode(link::Answer{}, payload_));
        }
      }
    }
    return !gone_;
  }
  [[nodiscard]] std::span<const std::uint8_t> Receive(std::span<std::uint8_t> bytes,
                                                      int /*timeout_ms*/) noexcept override {
    if (ready_.empty()) {
      Next();
    }
    const std::size_t count = std::min(bytes.size(), ready_.size());
    std::copy_n(ready_.begin(), count, bytes.begin());
    ready_ = ready_.subspan(count);
    return bytes.first(count);
  }
  [[nodiscard]] bool gone() const noexcept override { return gone_; }

 private:
  void Put(link::FrameKind kind, std::uint32_t sequence, link::Bytes payload) {
    ready_ = writer_.Encode({kind, sequence, payload});
  }
  void Next() {
    gone_ = input_.empty();
    switch (input_.Byte() % 4) {
      case 0: ready_ = input_.Take(input_.Byte()); break;
      case 1: Put(link::FrameKind::kCrash, 0, input_.Take(20)); break;
      case 2: {
        const auto kind =
            static_cast<link::FrameKind>(1 + input_.Byte() % static_cast<int>(link::FrameKind::kGo));
        Put(kind, input_.Byte(), input_.Take(input_.Byte()));
        break;
      }
      default: {
        link::Outputs outputs;
        outputs.tick_counts = input_.Word();
        outputs.periods_passed = input_.Byte();
        outputs.record.command.num_joints = 7;
        outputs.record.command.engage_brakes = (input_.Byte() & 1U) != 0;
        const link::Bytes sound = link::Encode(outputs, payload_);
        payload_[input_.Word() % sound.size()] = input_.Byte();
        Put(link::FrameKind::kOutputs, asked_, sound);
        break;
      }
    }
  }

  fuzz::Bytes& input_;
  link::FrameWriter writer_;
  std::array<std::uint8_t, link::kMaxPayload> payload_{};
  std::span<const std::uint8_t> ready_;
  link::FrameReader reader_;
  std::uint32_t asked_ = 0;
  bool gone_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kTicks = 40;
  static const config::ServoConfig config = test::PandaConfig();
  fuzz::Bytes input(data, size);
  sim::BoardConfig board;
  const std::uint8_t seed = input.Byte();
  board.by_timer = seed % 2 == 1;
  board.line = {.loss = 0.1, .jitter_ms = 3.0};
  sim::BoardServo servo(std::make_unique<AnyBoard>(input), board, seed, config, model::Load{});
  task::ServoInputs inputs;
  inputs.arm.num_joints = config.arm.num_joints;
  task::ServoOutputs outputs;
  for (int k = 0; k < kTicks; ++k) {
    inputs.arm.stamp_ns = k * hal::kTickPeriodNs;
    servo.Step(inputs, outputs);
    if (!servo.failure().empty()) {
      Require(outputs.record.command.engage_brakes, "a failed board engages the brakes");
      for (const double torque : outputs.record.command.tau_cmd) {
        Require(torque == 0.0, "a failed board commands zero torque");
      }
    }
  }
  Require(servo.Summarise().all.ticks <= kTicks, "each tick is counted at most once");
  return 0;
}
