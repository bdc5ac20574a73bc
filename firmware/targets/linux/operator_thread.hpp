// Who may have the arm moved, and for how long: words and signals, heard by a thread that does nothing else.
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

// What the threads of a run share: nobody waits for anybody.
struct RunControl {
  // Null until there is a connection; what they point to outlives the operator's thread.
  std::atomic<task::ServoLoop*> loop{nullptr};
  std::atomic<ArmDriver*> arm{nullptr};
  std::atomic<bool> enable_asked{false};
  std::atomic<bool> ended{false};               // it was told to
  std::atomic<bool> done{false};                // the servo's thread has nothing more to do
  std::atomic<std::int64_t> closing_ns{0};      // since then, of MonotonicNs(), files are written; 0: not yet
  std::atomic<std::int64_t> leave_until_ns{0};  // of the loop's clock, with a dead man
};

// Leave to move for `dead_man_s` from now on; for ever when that is 0.
void GiveLeave(double dead_man_s, const hal::Clock& clock, RunControl& control) noexcept;

struct Heard {
  std::int64_t stamp_ns = 0;  // of the loop's clock
  Word word = Word::kAlive;
  std::array<char, 64> unknown{};  // a line that is no word, as far as there is room; ends in 0
};

[[nodiscard]] const char* Name(Word word) noexcept;

class OperatorThread {
 public:
  struct Options {
    double dead_man_s = 0.0;
    bool allow_motion = true;
    int input_fd = STDIN_FILENO;
  };
  // All are borrowed.
  OperatorThread(const Options& options, const hal::Clock& clock, const linux_rt::SignalQueue& signals,
                 RunControl& control);

  // From one other thread: calls `take(heard)` for all that was heard, oldest first.
  template <typename Take>
  void Drain(Take&& take) {
    heard_.Drain(heard_.End(), take);
  }

 private:
  void HearAll(const std::stop_token& stop);
  void HearSignal();
  void HearWords();
  void End() noexcept;
  void Note(Word word, std::string_view unknown = {}) noexcept;

  const Options options_;
  const hal::Clock& clock_;
  const linux_rt::SignalQueue& signals_;
  RunControl& control_;
  OperatorInput input_;
  linux_rt::BoundedRing<Heard> heard_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace fovea::hw
