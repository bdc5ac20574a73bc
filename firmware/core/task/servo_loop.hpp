// SPDX-License-Identifier: Apache-2.0
// The loop around the servo task: reads the arm, steps the task, writes the arm, once per period.
//
// The same loop runs in the simulator, at either pace, and on the robot. Only the drivers differ.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/core/task/request_box.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/task/tuning_box.hpp"
#include "firmware/core/trajectory/plan_line.hpp"
#include "fovea/hal/arm.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::task {

struct LoopCounters {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;      // ticks that began a whole period or more late
  std::uint64_t missed_ticks = 0;  // periods that passed without a tick
  std::uint64_t arm_read_errors = 0;
  std::uint64_t arm_write_errors = 0;
  std::uint64_t lease_ends = 0;  // times that the permission to move expired
};

class ServoLoop {
 public:
  // The loop does not own its parts; they must outlive it.
  ServoLoop(ServoStep& task, hal::Arm& arm, hal::Clock& clock, hal::FeatureMailbox& features,
            hal::Recorder& recorder, hal::TickProbe& probe) noexcept;

  // Runs ticks until `end_ns` or Stop or the clock closes. Real-time: yes.
  // By the clock: at start, start + 1 ms, ... The grid is kept: a late tick is counted, the task learns how
  // many ticks were missed, and the next deadline is the next point of the grid.
  // By an arm that paces the loop: one tick for each state, or each time that the arm reports that none came.
  // Missed ticks follow from the states' stamps or, while the arm is silent, from the clock.
  [[nodiscard]] hal::Status Run(std::int64_t end_ns) noexcept;

  // From any thread: Run returns after the current tick.
  void Stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  // From any thread: every tick from now on gets a Hold request. Run returns once the arm is at rest or
  // braked, silent for some ticks, or after two seconds of ticks.
  void Finish() noexcept { finish_.store(true, std::memory_order_relaxed); }
  // From any thread: the first tick that Finish affected; kNever before.
  [[nodiscard]] std::uint64_t finish_tick() const noexcept {
    return finish_tick_.load(std::memory_order_acquire);
  }

  // From any thread: permits motion until this time of the loop's clock; without a call, for ever. After that
  // time each tick gets a Hold request, or a reset that was asked for, and no motion. A later permission does
  // not resume interrupted motion: requests in between are dropped, and a commanded motion must end before
  // another one is accepted.
  void GiveLeave(std::int64_t until_ns) noexcept {
    leave_until_ns_.store(until_ns, std::memory_order_relaxed);
  }
  // From any thread: how often the permission expired.
  [[nodiscard]] std::uint64_t lease_ends() const noexcept {
    return lease_ends_.load(std::memory_order_relaxed);
  }
  // Before Run: sets the source of commanded motions. Without it there are none.
  void UseMotion(moves::MotionSource& motion) noexcept { motion_ = &motion; }
  // Before Run: sets the planner's end of the line. Without it no plan comes.
  void UsePlanner(trajectory::PlanBox& planner) noexcept { planner_.Use(&planner); }
  // From any thread: passed to the task in the next tick, or in one of the two after it when several wait
  // (see RequestBox). A request after GiveLeave is handled with that permission.
  void Ask(Request request) noexcept { requests_.Put(request); }
  // The same, but a request that no tick has taken wins.
  void AskIfNoneWaits(Request request) noexcept { requests_.PutIfEmpty(request); }
  void Ask(config::MotionLawKind law) noexcept {
    law_.store(static_cast<int>(law), std::memory_order_relaxed);
  }
  // From any thread: passed to the task in one of the next ticks, one key per tick. The last value of each
  // key wins. The answer is in that tick's record. False: no key can have this number.
  [[nodiscard]] bool Ask(const config::Tuning& tuning) noexcept { return tunings_.Put(tuning); }

  // Only while no thread runs the loop.
  [[nodiscard]] LoopCounters counters() const noexcept;

  static constexpr std::uint64_t kNever = UINT64_MAX;
  // After this number of ticks in a row without a state, an arm counts as silent: a run that should finish
  // ends.
  static constexpr int kMostSilentTicks = 5;

 private:
  [[nodiscard]] hal::Status RunByClock(std::int64_t end_ns) noexcept;
  [[nodiscard]] hal::Status RunByArm(std::int64_t end_ns) noexcept;
  void CountMissed(std::int32_t missed_ticks) noexcept;
  void Tick(std::int32_t missed_ticks) noexcept;
  [[nodiscard]] bool MayMove() noexcept;
  [[nodiscard]] bool HasFinished() noexcept;

  ServoStep& task_;
  hal::Arm& arm_;
  hal::Clock& clock_;
  hal::FeatureMailbox& features_;
  hal::Recorder& recorder_;
  hal::TickProbe& probe_;
  static constexpr std::int64_t kForEver = INT64_MAX;

  std::atomic<bool> stop_{false};
  std::atomic<bool> finish_{false};
  std::atomic<std::uint64_t> finish_tick_{kNever};
  std::atomic<std::int64_t> leave_until_ns_{kForEver};
  std::atomic<std::uint64_t> lease_ends_{0};
  RequestBox requests_;
  std::atomic<int> law_{-1};  // requested; -1: none
  TuningBox tunings_;
  moves::MotionSource* motion_ = nullptr;
  trajectory::PlanLine planner_;
  bool leave_ended_ = false;    // in the last tick
  bool motion_barred_ = false;  // the present command was interrupted
  int finishing_ticks_ = 0;
  int silent_ticks_ = 0;  // of these, in a row without a state
  ServoInputs inputs_;
  ServoOutputs outputs_;
  LoopCounters counters_;
};

}  // namespace fovea::task
