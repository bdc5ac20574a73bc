// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/interrupt.hpp"

#include <pthread.h>

#include <csignal>
#include <cstdlib>
#include <utility>

namespace fovea::linux_rt {
namespace {

constexpr int kLookMs = 20;

}  // namespace

Interrupt::Interrupt() : signals_({SIGINT, SIGTERM, SIGHUP}), thread_([this] { Watch(); }) {}

Interrupt::~Interrupt() {
  done_ = true;
  thread_.join();
}

void Interrupt::SetLastAct(std::function<void()> act) {
  const std::lock_guard lock(mutex_);
  last_act_ = std::move(act);
}

void Interrupt::Watch() {
  while (!done_) {
    const int signal = signals_.Next(kLookMs);
    if (signal > 0 && came_.exchange(true)) {
      EndAtOnce(signal);
    }
  }
}

// Ends the process like the signal itself would, so that a shell sees the reason.
void Interrupt::EndAtOnce(int signal) {
  const std::lock_guard lock(mutex_);
  if (last_act_) {
    last_act_();
  }
  std::signal(signal, SIG_DFL);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace fovea::linux_rt
