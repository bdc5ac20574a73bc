// SPDX-License-Identifier: Apache-2.0
// Counts the time for which a condition holds, less the time for which it does not. Noise changes single
// ticks, so that the balance counts.
#pragma once

#include <algorithm>
#include <cstdint>

#include "fovea/hal/types.hpp"

namespace fovea::control {

// Adds a tick to `ns` if `holds`, else subtracts one, but not below 0. Real-time: yes.
inline void CountTick(bool holds, std::int64_t& ns) noexcept {
  ns = std::max<std::int64_t>(ns + (holds ? hal::kTickPeriodNs : -hal::kTickPeriodNs), 0);
}

}  // namespace fovea::control
