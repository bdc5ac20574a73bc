// SPDX-License-Identifier: Apache-2.0
// The loop's clocks for the two paces. The wait for the next tick advances the world.
#pragma once

#include <exception>
#include <functional>

#include "fovea/hal/clock.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// Called between ticks, after the world has advanced to `now_ns`. Returning false closes the clock.
using AfterAdvance = std::function<bool(std::int64_t now_ns)>;

// Advances the world. An exception of the world or of a callback must not pass through the loop: it is
// stored, the clock returns kClosed, and the loop's caller rethrows it afterwards.
class WorldStepper {
 public:
  WorldStepper(World& world, AfterAdvance after_advance);

  hal::Status AdvanceTo(std::int64_t time_ns) noexcept;
  [[nodiscard]] std::int64_t now_ns() const noexcept { return world_.now_ns(); }
  // Rethrows the stored exception, if any.
  void RethrowFailure() const;

 private:
  World& world_;
  AfterAdvance after_advance_;
  std::exception_ptr failure_;
};

// Virtual time, as fast as the machine can: bit-reproducible.
class LockstepClock final : public hal::Clock {
 public:
  LockstepClock(World& world, AfterAdvance after_advance);
  void RethrowFailure() const { stepper_.RethrowFailure(); }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return stepper_.now_ns(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  WorldStepper stepper_;
};

// Real time: sleeps on `clock`, then advances the world to its time. After a late tick, the world is as far
// as a real one; the last command acted in the meantime. Time 0 is the construction of this clock.
class RealPaceClock final : public hal::Clock {
 public:
  RealPaceClock(World& world, hal::Clock& clock, AfterAdvance after_advance);
  void RethrowFailure() const { stepper_.RethrowFailure(); }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs() - start_ns_; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  WorldStepper stepper_;
  hal::Clock& clock_;
  std::int64_t start_ns_;
};

}  // namespace fovea::sim
