// SPDX-License-Identifier: Apache-2.0
// The time interval in which a fault acts.
#pragma once

#include <cstdint>

namespace fovea::sim {

struct TimeWindow {
  double start_s = 0.0;
  double end_s = 0.0;  // exclusive; the fault never acts unless this is after start_s

  [[nodiscard]] bool Contains(std::int64_t time_ns) const noexcept {
    const double time_s = static_cast<double>(time_ns) * 1e-9;
    return time_s >= start_s && time_s < end_s;
  }
  [[nodiscard]] bool Begins() const noexcept { return end_s > start_s; }
};

}  // namespace fovea::sim
