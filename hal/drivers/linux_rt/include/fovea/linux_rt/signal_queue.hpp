// SPDX-License-Identifier: Apache-2.0
// Signals that the program polls instead of being interrupted by them.
#pragma once

#include <csignal>
#include <initializer_list>

namespace fovea::linux_rt {

// While it exists, only Next receives its signals. Create it before other threads, which then block these
// signals too. SIGHUP is left out if the process ignores it, because the process must outlive its terminal
// (nohup).
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
