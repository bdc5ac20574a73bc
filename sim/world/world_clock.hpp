// The two paces. Both are the loop's clock; waiting for the next tick is where the world moves on.
#pragma once

#include <exception>
#include <functional>

#include "fovea/hal/clock.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// Called after the world has moved on to `now_ns`, between ticks; false closes the clock.
using AfterAdvance = std::function<bool(std::int64_t now_ns)>;

// Moves the world on. What the world or those who look on throw must not pass through the loop: it is kept,
// the clock says kClosed, and whoever runs the loop asks for it afterwards.
class WorldStepper {
 public:
  WorldStepper(World& world, AfterAdvance after_advance);

  hal::Status AdvanceTo(std::int64_t time_ns) noexcept;
  [[nodiscard]] std::int64_t now_ns() const noexcept { return world_.now_ns(); }
  // Throws what was kept; nothing when all went well.
  void RethrowFailure() const;

 private:
  World& world_;
  AfterAdvance after_advance_;
  std::exception_ptr failure_;
};

// Virtual time, as fast as the machine goes: bit-reproducible.
class LockstepClock final : public hal::Clock {
 public:
  LockstepClock(World& world, AfterAdvance after_advance);
  void RethrowFailure() const { stepper_.RethrowFailure(); }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return stepper_.now_ns(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  WorldStepper stepper_;
};

// Real time: sleeps on `clock`, then brings the world up to it. A tick that comes late finds the world as
// far on as a real one would be, the last command in force meanwhile. Time 0 is when it was made.
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
