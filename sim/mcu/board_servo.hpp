// SPDX-License-Identifier: Apache-2.0
// The servo on a board, from the host's side: each tick sends a frame to the board and receives one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "firmware/core/link/frame.hpp"
#include "firmware/core/link/messages.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "fovea/hal/clock.hpp"
#include "sim/faults/link_faults.hpp"
#include "sim/mcu/board_figures.hpp"
#include "sim/mcu/board_line.hpp"
#include "sim/mcu/board_summary.hpp"

namespace fovea::sim {

struct BoardConfig {
  int instruction_ns = 64;  // the board's time per instruction, for the figures
  // The board ticks by its own timer, in virtual time. This time stands still while the host computes.
  bool by_timer = false;
  // With the timer: faults of the line, for states and torques. A tick uses what arrived before it.
  LinkFaults line;
  double line_from_s = 0.0;  // start of the line's faults, since the first tick
};

class BoardServo final : public task::ServoStep {
 public:
  // Configures the board's servo. `seed` is for the line's faults; `servo` is the servo's whole
  // configuration, whose arm includes `load`. std::runtime_error: the board does not start, does not answer,
  // or refuses the configuration.
  BoardServo(std::unique_ptr<BoardLine> line, const BoardConfig& config, std::uint64_t seed,
             const config::ServoConfig& servo, const model::Load& load);

  // Returns the record of the board's tick. Its command is the active one: an older one if the line is late,
  // and limited by the arm's torque rate. If the board has failed, or no torque has arrived for
  // safety.arm_lost_ticks, the command has no torque and closes the brakes.
  void Step(const task::ServoInputs& inputs, task::ServoOutputs& outputs) noexcept override;

  // Why the board failed; "" if it did not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  // Excess of the last tick over its period [ns], in whole periods.
  [[nodiscard]] std::int64_t OverrunNs() const noexcept;
  // Figures of all ticks so far.
  [[nodiscard]] BoardSummary Summarise() const;

 private:
  struct Up {
    std::uint32_t sequence = 0;
    task::ServoInputs inputs;
  };
  struct Down {
    std::uint32_t sequence = 0;
    hal::ArmCommand command;
  };

  void Start(const config::ServoConfig& servo, const model::Load& load);
  [[nodiscard]] bool Await(link::FrameKind kind, std::uint32_t sequence, int timeout_ms);
  [[nodiscard]] bool Exchange(const link::Frame& frame);
  [[nodiscard]] bool ExchangeByTimer(const task::ServoInputs& inputs);
  void TakeTorque();
  void NoteCrash();

  std::unique_ptr<BoardLine> line_;
  const BoardConfig config_;
  const std::int64_t torque_lost_ns_;
  link::FrameWriter writer_;
  link::FrameReader reader_;
  std::array<std::uint8_t, link::kMaxPayload> payload_{};
  std::array<std::uint8_t, 4096> received_{};
  std::span<const std::uint8_t> left_;  // unread part of `received_`
  std::uint32_t sequence_ = 0;
  link::Outputs answer_;
  BoardFigures figures_;
  std::uint64_t frames_sent_again_ = 0;
  std::uint64_t ticks_without_torque_ = 0;
  std::string failure_;
  std::string stopped_;  // why the brakes were closed although the board ticks

  // Used only with the timer
  FaultyLink<Up> up_;
  FaultyLink<Down> down_;
  std::int64_t now_ns_ = 0;
  std::int64_t torque_ns_ = 0;  // arrival of `in_force_`
  Down in_force_;
  hal::JointArray torque_step_{};  // largest change per tick, by the arm's torque rate [Nm]
};

// The loop's clock for a board with its own timer: a tick longer than its period delays the next tick.
class BoardClock final : public hal::Clock {
 public:
  // Both are borrowed.
  BoardClock(hal::Clock& clock, const BoardServo& board) : clock_(clock), board_(board) {}

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    return clock_.WaitUntil(deadline_ns + board_.OverrunNs());
  }

  hal::Clock& clock_;
  const BoardServo& board_;
};

}  // namespace fovea::sim
