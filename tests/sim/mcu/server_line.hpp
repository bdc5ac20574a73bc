// SPDX-License-Identifier: Apache-2.0
// A board without a processor: the servo behind the line runs in this process, and the test moves the timer.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>

#include "firmware/core/link/servo_server.hpp"
#include "sim/mcu/board_line.hpp"

namespace fovea::test {

class HandMovedBoard final : public link::Board {
 public:
  void Send(std::span<const std::uint8_t> bytes) noexcept override {
    sent.insert(sent.end(), bytes.begin(), bytes.end());
  }
  [[nodiscard]] std::uint32_t TimerCounts() noexcept override { return counts += 10; }
  [[nodiscard]] std::uint32_t StackBytes() noexcept override { return 1234; }
  [[nodiscard]] link::LineLosses Lost() noexcept override { return {}; }
  // The server stops the timer at the end of a tick; then the periods of that tick pass.
  void RunTimer(bool on) noexcept override {
    if (timer_runs && !on) {
      periods += periods_in_tick;
      passed_already = periods_in_tick > 0;
    }
    timer_runs = on;
  }
  [[nodiscard]] std::uint32_t Periods() noexcept override { return periods; }
  void Provoke(link::Provocation /*what*/) noexcept override {}

  std::deque<std::uint8_t> sent;
  bool timer_runs = false;
  std::uint32_t periods_in_tick = 0;
  bool passed_already = false;
  std::uint32_t periods = 0;
  std::uint32_t counts = 0;
};

class ServerLine final : public sim::BoardLine {
 public:
  explicit ServerLine(const model::ArmModel& arm) : server_(arm, board) { server_.SayHello(); }

  bool Send(std::span<const std::uint8_t> bytes) noexcept override {
    if (is_gone) {
      return false;
    }
    server_.Receive(bytes);
    if (board.timer_runs) {
      board.periods += board.passed_already ? 0 : 1;
      server_.Poll();
    }
    return true;
  }
  [[nodiscard]] std::span<const std::uint8_t> Receive(std::span<std::uint8_t> bytes,
                                                      int /*timeout_ms*/) noexcept override {
    const std::size_t count = is_gone ? 0 : std::min(bytes.size(), board.sent.size());
    std::copy_n(board.sent.begin(), count, bytes.begin());
    board.sent.erase(board.sent.begin(), board.sent.begin() + static_cast<std::ptrdiff_t>(count));
    return bytes.first(count);
  }
  [[nodiscard]] bool gone() const noexcept override { return is_gone; }

  HandMovedBoard board;
  bool is_gone = false;

 private:
  link::ServoServer server_;
};

}  // namespace fovea::test
