// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world_clock.hpp"

#include <utility>

namespace fovea::sim {

WorldStepper::WorldStepper(World& world, AfterAdvance after_advance)
    : world_(world), after_advance_(std::move(after_advance)) {}

hal::Status WorldStepper::AdvanceTo(std::int64_t time_ns) noexcept {
  try {
    world_.AdvanceTo(time_ns);
    if (after_advance_(world_.now_ns())) {
      return hal::Status::Ok();
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  return hal::Status(hal::StatusCode::kClosed, "sim clock");
}

void WorldStepper::RethrowFailure() const {
  if (failure_) {
    std::rethrow_exception(failure_);
  }
}

LockstepClock::LockstepClock(World& world, AfterAdvance after_advance)
    : stepper_(world, std::move(after_advance)) {}

hal::Status LockstepClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  return stepper_.AdvanceTo(deadline_ns);
}

RealPaceClock::RealPaceClock(World& world, hal::Clock& clock, AfterAdvance after_advance)
    : stepper_(world, std::move(after_advance)), clock_(clock), start_ns_(clock.NowNs()) {}

hal::Status RealPaceClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  if (const hal::Status status = clock_.WaitUntil(start_ns_ + deadline_ns); !status.ok()) {
    return status;
  }
  return stepper_.AdvanceTo(DoNowNs());
}

}  // namespace fovea::sim
