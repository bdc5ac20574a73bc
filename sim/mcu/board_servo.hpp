// The servo on a board: a tick here is a frame there and a frame back.
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
  int instruction_ns = 64;  // of the board's time, each: for the figures
  // The board ticks by its own timer, in virtual time: it stands while the host computes.
  bool by_timer = false;
  // By the timer: what the line does to states and to torques on their way. What comes between two ticks is
  // there at the second.
  LinkFaults line;
  double line_from_s = 0.0;  // since the first tick; the line is perfect before
};

class BoardServo final : public task::ServoStep {
 public:
  // Configures the board's servo. `seed` is of what the line does; `servo` is the whole of the servo's
  // configuration, its arm with `load`. std::runtime_error when the board does not start, does not answer, or
  // refuses.
  BoardServo(std::unique_ptr<BoardLine> line, const BoardConfig& config, std::uint64_t seed,
             const config::ServoConfig& servo, const model::Load& load);

  // The record is that of the board's tick; its command is the one that is in force, which is an older one
  // when the line is late, and no further from the last than the arm's torque rate allows. Once the board has
  // failed, or no torque has come for as long as an arm may be silent (safety.arm_lost_ticks): no torque,
  // brakes.
  void Step(const task::ServoInputs& inputs, task::ServoOutputs& outputs) noexcept override;

  // Why it has failed, "" while it has not.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  // By how much the last tick was longer than its period [ns], in whole periods.
  [[nodiscard]] std::int64_t OverrunNs() const noexcept;
  // Of all ticks so far.
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
  std::span<const std::uint8_t> left_;  // of `received_`, not looked at yet
  std::uint32_t sequence_ = 0;
  link::Outputs answer_;
  BoardFigures figures_;
  std::uint64_t frames_sent_again_ = 0;
  std::uint64_t ticks_without_torque_ = 0;
  std::string failure_;
  std::string stopped_;  // why the brakes were closed though the board ticks

  // By the timer
  FaultyLink<Up> up_;
  FaultyLink<Down> down_;
  std::int64_t now_ns_ = 0;
  std::int64_t torque_ns_ = 0;  // when `in_force_` came
  Down in_force_;
  hal::JointArray torque_step_{};  // most from one tick to the next, by the arm's torque rate [Nm]
};

// The loop's clock where a board ticks by its timer: a tick that took longer than its period delays the next.
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
