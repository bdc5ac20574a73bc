// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/frame_figures.hpp"

#include <algorithm>
#include <cstddef>

#include "fovea/hal/types.hpp"

namespace fovea::hw {
namespace {

constexpr double kMsPerNs = 1e-6;

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

FrameFigures FiguresOf(const std::vector<Arrival>& arrivals) {
  FrameFigures out;
  std::vector<double> periods;
  std::vector<double> latencies;
  periods.reserve(arrivals.size());
  latencies.reserve(arrivals.size());
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    latencies.push_back(kMsPerNs * static_cast<double>(arrivals[i].at_ns - arrivals[i].stamp_ns));
    out.latency_max_ms = std::max(out.latency_max_ms, latencies.back());
    if (i > 0) {
      periods.push_back(kMsPerNs * static_cast<double>(arrivals[i].stamp_ns - arrivals[i - 1].stamp_ns));
    }
  }
  out.period_ms = Median(periods);
  out.latency_ms = Median(latencies);
  out.late = static_cast<int>(std::count_if(latencies.begin(), latencies.end(), [&out](double latency_ms) {
    return latency_ms > out.latency_ms + 0.5 * out.period_ms;
  }));
  if (!periods.empty()) {
    out.rate_hz = static_cast<double>(hal::kNsPerSecond) * static_cast<double>(periods.size()) /
                  static_cast<double>(arrivals.back().stamp_ns - arrivals.front().stamp_ns);
  }
  return out;
}

}  // namespace fovea::hw
