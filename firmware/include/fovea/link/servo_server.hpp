// The servo at the far end of a serial line: takes frames, steps the task, sends what came of it. All that a
// processor without an operating system runs, but for the processor itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "fovea/link/frame.hpp"
#include "fovea/link/messages.hpp"

namespace fovea::link {

// What the server needs of its processor. Real-time: yes.
class Board {
 public:
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;
  virtual void Send(std::span<const std::uint8_t> bytes) noexcept = 0;
  [[nodiscard]] virtual std::uint32_t TimerCounts() noexcept = 0;  // runs freely, upwards, wraps
  [[nodiscard]] virtual std::uint32_t StackBytes() noexcept = 0;   // the deepest the stack ever was
  virtual void Provoke(Provocation what) noexcept = 0;

 protected:
  Board() noexcept = default;
  ~Board() = default;
};

class ServoServer final : private servo::StageProbe {
 public:
  // `arm` without load. Both are borrowed.
  ServoServer(const model::ArmModel& arm, Board& board) noexcept : arm_(arm), board_(board) {}

  void SayHello() noexcept;
  void Receive(std::uint8_t byte) noexcept;
  // Of Pacing::kTimer: one period has passed since the last call, and `missed_ticks` before it.
  void TickByTimer(std::int32_t missed_ticks) noexcept;

  [[nodiscard]] bool TicksByTimer() const noexcept {
    return configured_ && configuration_.pacing == Pacing::kTimer;
  }

 private:
  void Done(servo::Stage stage) noexcept override;
  void Take(const Frame& frame) noexcept;
  void Configure(const Frame& frame) noexcept;
  void TakeInputs(const Frame& frame) noexcept;
  void Step(std::uint32_t sequence) noexcept;
  template <class Message>
  void Send(FrameKind kind, std::uint32_t sequence, const Message& message) noexcept;

  const model::ArmModel& arm_;
  Board& board_;
  FrameReader reader_;
  FrameWriter writer_;
  std::array<std::uint8_t, kMaxPayload> payload_{};
  Configuration configuration_;
  bool configured_ = false;
  servo::ServoTask task_;
  servo::ServoInputs inputs_;
  servo::ServoInputs received_;
  servo::ServoOutputs outputs_;
  Outputs sent_;
  bool answered_ = false;  // `sent_` answers `sequence_`
  std::uint32_t sequence_ = 0;
  bool fresh_ = false;  // of kTimer: `inputs_` came since the last tick
  std::uint32_t silent_ticks_ = 0;
  std::uint32_t stage_began_ = 0;
};

}  // namespace fovea::link
