// The loop around the servo task: reads the arm, steps the task, writes the arm, once per period.
//
// The same loop runs in the simulator at either pace and on the robot; only what stands behind the seam
// differs.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/core/task/servo_task.hpp"
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
  std::uint64_t lease_ends = 0;  // times that the leave to move ran out
};

class ServoLoop {
 public:
  // The parts are borrowed; they outlive the loop.
  ServoLoop(ServoStep& task, hal::Arm& arm, hal::Clock& clock, hal::FeatureMailbox& features,
            hal::Recorder& recorder, hal::TickProbe& probe) noexcept;

  // Runs ticks until `end_ns` or Stop or the clock closes. Real-time: yes.
  // By the clock: at start, start + 1 ms, ... The grid is kept: a tick that comes late is counted, what it
  // missed is told to the task, and the next deadline is the next point of the grid.
  // By an arm that paces the loop: one tick for each state, or each time that it says none came; ticks are
  // missed where the states' stamps say so, or, while it is silent, the clock.
  [[nodiscard]] hal::Status Run(std::int64_t end_ns) noexcept;

  // From any thread: Run returns after the tick in hand.
  void Stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  // From any thread: every tick from now on is asked to hold, and Run returns once the arm is at rest or
  // braked, silent for some ticks, or after two seconds' worth of ticks.
  void Finish() noexcept { finish_.store(true, std::memory_order_relaxed); }
  // From any thread: the first tick that Finish had its say in; kNever before.
  [[nodiscard]] std::uint64_t finish_tick() const noexcept {
    return finish_tick_.load(std::memory_order_acquire);
  }

  // From any thread: the arm may be moved until this time of the loop's clock; for ever where this is never
  // called. Past it each tick is asked to hold and gets no motion. Later leave does not take up what was
  // broken off: whatever was asked for meanwhile is forgotten, and a commanded motion must end before another
  // one is taken.
  void GiveLeave(std::int64_t until_ns) noexcept {
    leave_until_ns_.store(until_ns, std::memory_order_relaxed);
  }
  // From any thread: how often it ran out.
  [[nodiscard]] std::uint64_t lease_ends() const noexcept {
    return lease_ends_.load(std::memory_order_relaxed);
  }
  // Before Run: where commanded motions come from. Without it there are none.
  void UseMotion(moves::MotionSource& motion) noexcept { motion_ = &motion; }
  // From any thread: handed to the task in the next tick; the last one before that tick wins.
  // Who gives leave first and asks then is heard with that leave.
  void Ask(Request request) noexcept { request_.store(request, std::memory_order_release); }
  void Ask(config::MotionLawKind law) noexcept {
    law_.store(static_cast<int>(law), std::memory_order_relaxed);
  }

  // When no thread runs it.
  [[nodiscard]] LoopCounters counters() const noexcept;

  static constexpr std::uint64_t kNever = UINT64_MAX;

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
  std::atomic<Request> request_{Request::kNone};
  std::atomic<int> law_{-1};  // asked for; -1: none
  moves::MotionSource* motion_ = nullptr;
  bool leave_ended_ = false;    // in the last tick
  bool motion_barred_ = false;  // what is commanded now was broken off
  int finishing_ticks_ = 0;
  int silent_ticks_ = 0;  // of these, in a row without a state
  ServoInputs inputs_;
  ServoOutputs outputs_;
  LoopCounters counters_;
};

}  // namespace fovea::task
