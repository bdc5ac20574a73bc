// SPDX-License-Identifier: Apache-2.0
// The servo at the far end of a serial line: takes frames, steps the task, sends the result. It is all that a
// processor without an operating system runs, apart from the processor's own driver.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/link/frame.hpp"
#include "firmware/core/link/messages.hpp"
#include "firmware/core/task/request_box.hpp"

namespace fovea::link {

// What a processor lost on its line so far.
struct LineLosses {
  std::uint32_t bytes = 0;   // received without room for them
  std::uint32_t frames = 0;  // without room to be sent
};

// The functions that the server needs of its processor. Real-time: yes.
class Board {
 public:
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;
  virtual void Send(std::span<const std::uint8_t> bytes) noexcept = 0;
  [[nodiscard]] virtual std::uint32_t TimerCounts() noexcept = 0;  // runs freely, upwards, wraps
  [[nodiscard]] virtual std::uint32_t StackBytes() noexcept = 0;   // the largest stack depth so far
  [[nodiscard]] virtual LineLosses Lost() noexcept = 0;
  // The 1 kHz timer. A stopped timer keeps the elapsed part of its period.
  virtual void RunTimer(bool on) noexcept = 0;
  [[nodiscard]] virtual std::uint32_t Periods() noexcept = 0;  // of that timer, elapsed so far; wraps
  virtual void Provoke(Provocation what) noexcept = 0;

 protected:
  Board() noexcept = default;
  ~Board() = default;
};

class ServoServer final : private task::StageProbe {
 public:
  // `arm`: without load. Both must outlive the server.
  ServoServer(const model::ArmModel& arm, Board& board) noexcept : arm_(arm), board_(board) {}

  void SayHello() noexcept;
  void Receive(std::span<const std::uint8_t> bytes) noexcept;
  // Call whenever a period may have passed: ticks if one has.
  void Poll() noexcept;

 private:
  void MarkStageEnd(task::Stage stage) noexcept override;
  void Take(const Frame& frame) noexcept;
  void Configure(const Frame& frame) noexcept;
  void TakeInputs(const Frame& frame) noexcept;
  void TakeInputsByTimer(const Frame& frame) noexcept;
  [[nodiscard]] bool ComesTooLate(std::int64_t stamp_ns) noexcept;
  void LetTimerRun(const Frame& frame) noexcept;
  void TickByTimer(std::int32_t missed_ticks) noexcept;
  [[nodiscard]] LineCounters Counters() noexcept;
  void Step() noexcept;
  template <class Message>
  void Send(FrameKind kind, std::uint32_t sequence, const Message& message) noexcept;

  const model::ArmModel& arm_;
  Board& board_;
  FrameReader reader_;
  FrameWriter writer_;
  std::array<std::uint8_t, kMaxPayload> payload_{};
  Configuration configuration_;
  bool configured_ = false;
  task::ServoTask task_;
  task::ServoInputs inputs_;
  task::ServoInputs received_;
  task::ServoOutputs outputs_;
  Outputs sent_;
  bool answered_ = false;  // `sent_` answers `sequence_`
  std::uint32_t sequence_ = 0;
  std::uint32_t link_counts_ = 0;

  // By the timer
  bool fresh_ = false;         // `inputs_` came since the last tick
  task::RequestBox requests_;  // no tick has taken them
  bool has_inputs_ = false;    // some came, the newest of them `inputs_sequence_`
  std::uint32_t inputs_sequence_ = 0;
  bool may_tick_ = false;           // false: the timer stands until the host sends Go
  std::uint32_t periods_done_ = 0;  // of Board::Periods
  std::int64_t time_ns_ = 0;        // of the timer's ticks
  std::int64_t least_lag_ns_ = 0;   // the smallest lag of a state's stamp behind them
  LineCounters line_;
  std::uint32_t damaged_before_ = 0;  // damaged frames before this configuration
  std::uint32_t stage_began_ = 0;
};

}  // namespace fovea::link
