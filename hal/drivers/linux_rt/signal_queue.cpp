// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/signal_queue.hpp"

#include <pthread.h>

#include <ctime>

namespace fovea::linux_rt {
namespace {

bool IsIgnored(int number) {
  struct sigaction action {};
  return sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

SignalQueue::SignalQueue(std::initializer_list<int> numbers) {
  sigemptyset(&set_);
  for (const int number : numbers) {
    if (number != SIGHUP || !IsIgnored(SIGHUP)) {
      sigaddset(&set_, number);
    }
  }
  pthread_sigmask(SIG_BLOCK, &set_, &before_);
}

SignalQueue::~SignalQueue() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

int SignalQueue::Next(int wait_ms) const {
  constexpr long kNsPerMs = 1'000'000;
  const timespec wait{0, wait_ms * kNsPerMs};
  return sigtimedwait(&set_, nullptr, &wait);
}

}  // namespace fovea::linux_rt
