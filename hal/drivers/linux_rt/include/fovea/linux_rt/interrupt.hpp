// SPDX-License-Identifier: Apache-2.0
// Ctrl-C as a request to end: the first SIGINT, SIGTERM or SIGHUP sets a flag, the second ends the process.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "fovea/linux_rt/signal_queue.hpp"

namespace fovea::linux_rt {

class Interrupt {
 public:
  // Create it before other threads, which then leave these signals to it.
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // From any thread: whether to end early. Real-time: yes.
  [[nodiscard]] bool Came() const noexcept { return came_.load(std::memory_order_relaxed); }
  // Sets the last action before the process ends at once, run by the signal thread; empty: none. Returns when
  // the previous action is not running.
  void SetLastAct(std::function<void()> act);

 private:
  void Watch();
  [[noreturn]] void EndAtOnce(int signal);

  const SignalQueue signals_;
  std::atomic<bool> came_{false};
  std::atomic<bool> done_{false};
  std::mutex mutex_;
  std::function<void()> last_act_;
  std::thread thread_;
};

}  // namespace fovea::linux_rt
