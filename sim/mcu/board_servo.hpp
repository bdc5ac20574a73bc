// The servo on a board: a tick here is a frame there and a frame back.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fovea/link/frame.hpp"
#include "fovea/link/messages.hpp"
#include "fovea/servo/servo_task.hpp"
#include "sim/app/summary.hpp"
#include "sim/mcu/qemu.hpp"

namespace fovea::sim {

class BoardServo final : public servo::ServoStep {
 public:
  // Starts the board and configures its servo. `config` is the whole of it, its arm with `load`.
  // std::runtime_error when the board does not start, does not answer, or refuses.
  BoardServo(const QemuConfig& qemu, const servo::ServoConfig& config, const model::Load& load);

  // Once the board has failed: no torque, brakes.
  void Step(const servo::ServoInputs& inputs, servo::ServoOutputs& outputs) noexcept override;

  // Why it has failed, "" while it has not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  // Of all ticks so far.
  [[nodiscard]] BoardSummary Summarise() const;

 private:
  [[nodiscard]] bool Await(link::FrameKind kind, std::uint32_t sequence, int timeout_ms);
  [[nodiscard]] bool Exchange(const servo::ServoInputs& inputs);
  void NoteCrash();
  void NoteFigures();

  Qemu qemu_;
  double instructions_per_count_;
  link::FrameWriter writer_;
  link::FrameReader reader_;
  std::array<std::uint8_t, link::kMaxPayload> payload_{};
  std::array<std::uint8_t, 4096> received_{};
  std::span<const std::uint8_t> left_;  // of `received_`, not looked at yet
  std::uint32_t sequence_ = 0;
  link::Outputs answer_;
  std::vector<std::uint32_t> tick_counts_;                      // of each tick
  std::array<std::uint64_t, link::kNumStages> stage_counts_{};  // in all
  std::uint32_t stack_bytes_ = 0;
  std::uint64_t frames_sent_again_ = 0;
  std::string failure_;
};

}  // namespace fovea::sim
