// SPDX-License-Identifier: Apache-2.0
// The range of a device's stamps. A device can report any number as its time.
#pragma once

#include <cstdint>
#include <optional>

namespace fovea::camera {

// A value beyond this, positive or negative, is not a stamp: 73 years, more than any clock has counted since
// 1970. Differences of larger values could overflow.
inline constexpr std::int64_t kMostStampNs = std::int64_t{1} << 61U;

inline bool IsStamp(std::int64_t device_ns) {
  return device_ns >= -kMostStampNs && device_ns <= kMostStampNs;
}

// The stamp [ns] of a clock that counts `ticks` of `ns_per_tick`, exact to the nanosecond; none if it is
// out of range.
std::optional<std::int64_t> StampOfTicks(std::int64_t ticks, double ns_per_tick);

}  // namespace fovea::camera
