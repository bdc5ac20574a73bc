// How often pictures come, and how late.
#pragma once

#include <cstdint>
#include <vector>

namespace fovea::hw {

// A frame that came.
struct Arrival {
  std::int64_t stamp_ns = 0;  // mid-exposure
  std::int64_t at_ns = 0;     // when it was here, by the same clock
};

struct FrameFigures {
  double rate_hz = 0.0;     // by their stamps; 0 of fewer than two
  double period_ms = 0.0;   // the usual one, between two stamps
  double latency_ms = 0.0;  // from exposure to arrival, the usual one
  double latency_max_ms = 0.0;
  int late = 0;  // that came more than half a period later than usual
};

// In the order in which they came.
FrameFigures FiguresOf(const std::vector<Arrival>& arrivals);

}  // namespace fovea::hw
