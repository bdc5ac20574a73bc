// SPDX-License-Identifier: Apache-2.0
// Finds out what a run tells while it goes on: a thread of its own, beside the tick, and never in it.
//
//   records -> Add -> thread: RunWatch, every half second of ticks -> findings -> Learner -> Act -> loop
//
// An estimate over a minute of views takes up to a second of a processor, so it cannot be part of the thread
// that takes the records. It is over the records up to a fixed tick, and thus the same however long it takes.
// In lockstep it is due a fixed number of ticks later, and the caller waits for it there, as it waits for a
// picture: so the run is reproducible to the last bit. At real pace it is due when it is done.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/beliefs/learner.hpp"
#include "firmware/host/beliefs/run_watch.hpp"

namespace fovea::beliefs {

struct FinderConfig {
  Learns learns;
  bool is_shown = false;  // somebody looks at the findings while the run goes on
  bool waits = false;     // for an estimate that is due, if the servo learns from it: lockstep
};

class Finder {
 public:
  static constexpr std::uint64_t kEveryTicks = 500;  // from one estimate to the next
  static constexpr std::uint64_t kDueTicks = 250;    // from an estimate's last record to its use, in lockstep

  Finder(const config::ServoConfig& config, const Configured& configured, const FinderConfig& finder);
  ~Finder();
  Finder(const Finder&) = delete;
  Finder& operator=(const Finder&) = delete;

  // All functions but UseLoop from one thread.
  // A tick's record, in their order.
  void Add(const hal::TickRecord& record);
  // What to ask of the servo's loop now. Call after each Add in lockstep, often at real pace.
  [[nodiscard]] std::vector<config::Tuning> TakeRequests();
  // Asks it of the loop in use, if there is one.
  void Act();
  // From the thread that runs `loop`, while no tick runs. Null: it is no longer there.
  void UseLoop(task::ServoLoop* loop);
  // The newest findings of the run that goes on; null before the first.
  [[nodiscard]] const Findings* now() const { return now_ ? &*now_ : nullptr; }
  // When the run is done: of all its records.
  [[nodiscard]] Findings Finish();

 private:
  struct Job {
    std::vector<hal::TickRecord> records;
    bool estimate = false;
  };
  void Hand(bool estimate);
  [[nodiscard]] std::optional<Findings> TakeResult(bool wait);
  void Work(const std::stop_token& stop);

  const bool waits_;
  const bool estimates_;  // while the run goes on
  Learner learner_;
  Job job_;  // that is being filled
  std::uint64_t next_tick_ = kEveryTicks;
  std::optional<std::uint64_t> begun_tick_;  // of the estimate that is under way
  std::uint64_t newest_tick_ = 0;
  std::optional<Findings> now_;

  std::mutex loop_mutex_;
  task::ServoLoop* loop_ = nullptr;  // under loop_mutex_

  RunWatch watch_;  // of the thread
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<Job> jobs_;           // under mutex_, for the thread
  std::optional<Findings> result_;  // under mutex_, from the thread
  std::jthread thread_;             // last: it uses all others
};

}  // namespace fovea::beliefs
