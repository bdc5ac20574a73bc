// From when until when a fault lasts.
#pragma once

#include <cstdint>

namespace fovea::sim {

struct TimeWindow {
  double start_s = 0.0;
  double end_s = 0.0;  // the first moment after it; not after start_s: it never begins

  [[nodiscard]] bool Contains(std::int64_t time_ns) const noexcept {
    const double time_s = static_cast<double>(time_ns) * 1e-9;
    return time_s >= start_s && time_s < end_s;
  }
  [[nodiscard]] bool Begins() const noexcept { return end_s > start_s; }
};

}  // namespace fovea::sim
