// What a device may say of its time: any number, of which not all are stamps.
#pragma once

#include <cstdint>
#include <optional>

namespace fovea::camera {

// A stamp beyond this, forwards or backwards, is none: 73 years, more than any clock counts since 1970.
// Differences of those that are none would have no room.
inline constexpr std::int64_t kMostStampNs = std::int64_t{1} << 61U;

inline bool IsStamp(std::int64_t device_ns) {
  return device_ns >= -kMostStampNs && device_ns <= kMostStampNs;
}

// The stamp [ns] of a clock that counts `ticks` of `ns_per_tick`, exact to the nanosecond; none when it is
// none.
std::optional<std::int64_t> StampOfTicks(std::int64_t ticks, double ns_per_tick);

}  // namespace fovea::camera
