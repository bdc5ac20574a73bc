#include "sim/world/world_clock.hpp"

#include <utility>

namespace fovea::sim {
namespace {

hal::Status Advance(World& world, std::int64_t time_ns, const AfterAdvance& after_advance) {
  world.AdvanceTo(time_ns);
  return after_advance(world.now_ns()) ? hal::Status::Ok()
                                       : hal::Status(hal::StatusCode::kClosed, "sim clock");
}

}  // namespace

LockstepClock::LockstepClock(World& world, AfterAdvance after_advance)
    : world_(world), after_advance_(std::move(after_advance)) {}

hal::Status LockstepClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  return Advance(world_, deadline_ns, after_advance_);
}

RealPaceClock::RealPaceClock(World& world, hal::Clock& clock, AfterAdvance after_advance)
    : world_(world), clock_(clock), after_advance_(std::move(after_advance)), start_ns_(clock.NowNs()) {}

hal::Status RealPaceClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  if (const hal::Status status = clock_.WaitUntil(start_ns_ + deadline_ns); !status.ok()) {
    return status;
  }
  return Advance(world_, DoNowNs(), after_advance_);
}

}  // namespace fovea::sim
