// SPDX-License-Identifier: Apache-2.0
#include "fovea/camera/stamp.hpp"

#include <cmath>

namespace fovea::camera {

std::optional<std::int64_t> StampOfTicks(std::int64_t ticks, double ns_per_tick) {
  constexpr auto kMost = static_cast<double>(kMostStampNs);
  const bool is_period = ns_per_tick > 0.0 && ns_per_tick <= kMost;
  if (!is_period || std::fabs(static_cast<double>(ticks) * ns_per_tick) > kMost) {
    return std::nullopt;
  }
  // Whole nanoseconds per tick in integers: a double cannot hold a long uptime to the nanosecond.
  const auto whole_ns = static_cast<std::int64_t>(ns_per_tick);
  const double rest_ns = ns_per_tick - static_cast<double>(whole_ns);
  const std::int64_t stamp_ns = ticks * whole_ns + std::llround(static_cast<double>(ticks) * rest_ns);
  return IsStamp(stamp_ns) ? std::optional(stamp_ns) : std::nullopt;
}

}  // namespace fovea::camera
