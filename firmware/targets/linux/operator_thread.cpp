// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/operator_thread.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"

namespace fovea::hw {
namespace {

constexpr int kLookMs = 5;
constexpr std::size_t kHeardRing = 256;
// After this time the next signal ends the program, even if files are not written.
constexpr std::int64_t kClosingNs = 5 * hal::kNsPerSecond;

}  // namespace

const char* Name(Word word) noexcept {
  switch (word) {
    case Word::kAlive: return "alive";
    case Word::kEnable: return "enable";
    case Word::kTrack: return "track";
    case Word::kHold: return "hold";
    case Word::kRecover: return "recover";
    case Word::kEnd: return "end";
  }
  return "unknown";
}

void GiveLeave(double dead_man_s, const hal::Clock& clock, RunControl& control) noexcept {
  task::ServoLoop* loop = control.loop;
  if (dead_man_s <= 0.0 || loop == nullptr) {
    return;
  }
  const std::int64_t now_ns = clock.NowNs();
  if (now_ns >= control.leave_until_ns) {
    loop->Ask(task::Request::kNone);  // drops an earlier request to move, also if the loop does not run yet
  }
  const auto lasts_ns = static_cast<std::int64_t>(dead_man_s * static_cast<double>(hal::kNsPerSecond));
  control.leave_until_ns = now_ns + lasts_ns;
  loop->GiveLeave(now_ns + lasts_ns);
}

void EndRun(bool allow_motion, bool at_once, RunControl& control) noexcept {
  control.ended = true;
  if (task::ServoLoop* loop = control.loop) {
    if (at_once || !allow_motion) {
      loop->Stop();
    } else {
      loop->Finish();
    }
  }
}

OperatorThread::OperatorThread(const Options& options, const hal::Clock& clock,
                               const linux_rt::SignalQueue& signals, RunControl& control)
    : options_(options),
      clock_(clock),
      signals_(signals),
      control_(control),
      input_(options.input_fd),
      heard_(kHeardRing),
      thread_([this](const std::stop_token& stop) { HearAll(stop); }) {}

void OperatorThread::HearAll(const std::stop_token& stop) {
  pthread_setname_np(pthread_self(), "fovea-operator");
  // Runs before other busy programs, if that is granted; the servo's priority is higher.
  static_cast<void>(linux_rt::MakeThreadRealtime({.fifo_priority = 1,
                                                  .lock_memory = false,
                                                  .stack_prefault_kib = 0,
                                                  .keep_awake = false,
                                                  .keep_memory = false}));
  while (!stop.stop_requested()) {
    HearSignal();
    HearWords();
  }
}

void OperatorThread::HearSignal() {
  const int signal = signals_.Next(kLookMs);
  if (signal == SIGUSR1) {
    if (ArmDriver* arm = control_.arm) {
      arm->AskRecovery();
    }
    Note(Word::kRecover);
  } else if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) {
    const std::int64_t closing_ns = control_.closing_ns;
    if (closing_ns == 0) {
      End();
    } else if (linux_rt::MonotonicNs() - closing_ns > kClosingNs) {
      std::_Exit(EXIT_FAILURE);  // the disk hangs; the robot is already released
    }
  }
}

void OperatorThread::HearWords() {
  while (const std::optional<Word> word = input_.Next()) {
    GiveLeave(options_.dead_man_s, clock_, control_);
    switch (*word) {
      case Word::kEnable: control_.enable_asked = true; break;
      case Word::kTrack:
      case Word::kHold:
        control_.hold_asked = *word == Word::kHold;
        // Read after that: Connect sets the loop, and then looks whether a Hold was asked for.
        if (task::ServoLoop* loop = control_.loop) {
          loop->Ask(*word == Word::kTrack ? task::Request::kTrack : task::Request::kHold);
        }
        break;
      case Word::kRecover:
        if (ArmDriver* arm = control_.arm) {
          arm->AskRecovery();
        }
        break;
      case Word::kEnd: End(); continue;
      case Word::kAlive: Note(Word::kAlive, input_.TakeUnknown()); continue;
    }
    Note(*word);
  }
}

void OperatorThread::End() noexcept {
  EndRun(options_.allow_motion, std::exchange(end_asked_, true), control_);
  Note(Word::kEnd);
}

void OperatorThread::Note(Word word, std::string_view unknown) noexcept {
  heard_.Fill([&](Heard& place) {
    place.stamp_ns = clock_.NowNs();
    place.word = word;
    place.unknown = {};
    std::copy_n(unknown.begin(), std::min(unknown.size(), place.unknown.size() - 1), place.unknown.begin());
  });
}

}  // namespace fovea::hw
