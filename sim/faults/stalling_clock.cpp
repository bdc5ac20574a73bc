// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/stalling_clock.hpp"

#include "fovea/hal/types.hpp"
#include "sim/faults/chance.hpp"

namespace fovea::sim {

hal::Status StallingClock::DoWaitUntil(std::int64_t deadline_ns) noexcept {
  const auto swallowed = [this](std::int64_t tick_ns) {
    return tick_ns < end_ns_ && fault_.window.Contains(tick_ns) &&
           Chance(fault_.seed, static_cast<std::uint64_t>(tick_ns / hal::kTickPeriodNs)) < fault_.share;
  };
  hal::Status status = clock_.WaitUntil(deadline_ns);
  while (status.ok() && swallowed(deadline_ns)) {
    deadline_ns += hal::kTickPeriodNs;
    status = clock_.WaitUntil(deadline_ns);
  }
  return status;
}

}  // namespace fovea::sim
