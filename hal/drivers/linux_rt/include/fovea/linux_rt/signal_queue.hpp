// Signals as something to ask for, instead of something that interrupts.
#pragma once

#include <csignal>
#include <initializer_list>

namespace fovea::linux_rt {

// While one lives, the signals that it names come to Next and to nobody else. Made before other threads are,
// which then block them too. SIGHUP is left out where the process ignores it, since it shall outlive its
// terminal (nohup).
class SignalQueue {
 public:
  SignalQueue(std::initializer_list<int> numbers);
  ~SignalQueue();
  SignalQueue(const SignalQueue&) = delete;
  SignalQueue& operator=(const SignalQueue&) = delete;

  // The next signal, or -1 when none came within `wait_ms` [0 to 999].
  [[nodiscard]] int Next(int wait_ms) const;

 private:
  sigset_t set_{};
  sigset_t before_{};
};

}  // namespace fovea::linux_rt
