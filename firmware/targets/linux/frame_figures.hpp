// SPDX-License-Identifier: Apache-2.0
// The rate and the latency of a camera's pictures.
#pragma once

#include <cstdint>
#include <vector>

namespace fovea::hw {

// A frame that arrived.
struct Arrival {
  std::int64_t stamp_ns = 0;  // mid-exposure
  std::int64_t at_ns = 0;     // arrival, by the same clock
};

struct FrameFigures {
  double rate_hz = 0.0;     // by the stamps; 0 for fewer than two frames
  double period_ms = 0.0;   // median time between two stamps
  double latency_ms = 0.0;  // median time from exposure to arrival
  double latency_max_ms = 0.0;
  int late = 0;  // frames whose latency is above the median by more than half a period
};

// `arrivals` in the order of arrival.
FrameFigures FiguresOf(const std::vector<Arrival>& arrivals);

}  // namespace fovea::hw
