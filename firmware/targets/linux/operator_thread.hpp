// SPDX-License-Identifier: Apache-2.0
// The operator's thread: reads words and signals, and renews the permission to move.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>
#include <thread>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/targets/linux/operator_input.hpp"
#include "firmware/targets/linux/robots/arm_driver.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/linux_rt/bounded_ring.hpp"
#include "fovea/linux_rt/signal_queue.hpp"

namespace fovea::hw {

// Data that the threads of a run share; no thread waits for another.
struct RunControl {
  // Null until there is a connection. The objects outlive the operator's thread.
  std::atomic<task::ServoLoop*> loop{nullptr};
  std::atomic<ArmDriver*> arm{nullptr};
  std::atomic<bool> enable_asked{false};
  std::atomic<bool> hold_asked{false};          // typed, and no "track" since
  std::atomic<bool> serves{false};              // motion is enabled, and the servo runs
  std::atomic<bool> ended{false};               // somebody requested the end
  std::atomic<bool> done{false};                // the servo's thread has nothing more to do
  std::atomic<std::int64_t> closing_ns{0};      // when the writing of files began, MonotonicNs(); 0: not yet
  std::atomic<std::int64_t> leave_until_ns{0};  // end of the permission to move, by the loop's clock
};

// Permits motion for `dead_man_s` from now on. Does nothing when that is 0: the permission never ends.
void GiveLeave(double dead_man_s, const hal::Clock& clock, RunControl& control) noexcept;

// Ends the run, in order or at once.
void EndRun(bool allow_motion, bool at_once, RunControl& control) noexcept;

struct Heard {
  std::int64_t stamp_ns = 0;  // of the loop's clock
  Word word = Word::kAlive;
  std::array<char, 64> unknown{};  // an unknown line, truncated to fit; ends in 0
};

[[nodiscard]] const char* Name(Word word) noexcept;

class OperatorThread {
 public:
  struct Options {
    double dead_man_s = 0.0;
    bool allow_motion = true;
    int input_fd = STDIN_FILENO;
  };
  // Borrows all.
  OperatorThread(const Options& options, const hal::Clock& clock, const linux_rt::SignalQueue& signals,
                 RunControl& control);

  // From one other thread: calls `take(heard)` for each word and signal, oldest first.
  template <typename Take>
  void Drain(Take&& take) {
    heard_.Drain(heard_.End(), take);
  }

 private:
  void HearAll(const std::stop_token& stop);
  void HearSignal();
  void HearWords();
  // The operator's first request ends the run in order, the second at once, whoever else has asked before.
  void End() noexcept;
  void Note(Word word, std::string_view unknown = {}) noexcept;

  const Options options_;
  const hal::Clock& clock_;
  const linux_rt::SignalQueue& signals_;
  RunControl& control_;
  OperatorInput input_;
  bool end_asked_ = false;
  linux_rt::BoundedRing<Heard> heard_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace fovea::hw
