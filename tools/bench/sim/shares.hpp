// SPDX-License-Identifier: Apache-2.0
// How a simulated run spends its time, and how that time grows, from the timelines of short runs.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// Sums over the spans of one timeline [us].
struct SpanSums {
  double wall_us = 0.0;  // from the timeline's zero to the end of the last span
  double physics_us = 0.0;
  double servo_us = 0.0;
  double render_us = 0.0;
  double read_back_us = 0.0;
  double sensor_us = 0.0;
  double detection_us = 0.0;
  double logging_us = 0.0;  // of the run's own threads, for log and film
  int ticks = 0;
  int pictures = 0;
};

// Sums a file that `fovea-sim run --trace` wrote in lockstep. std::runtime_error when it is not a timeline.
SpanSums SumSpans(const std::filesystem::path& file);

// Shares of the wall time of `ball`. They add up to more than 1 when threads work in parallel. Also the time
// of a physics step by number of joints, and of a picture by pixels and clutter. `program` is fovea-sim.
std::vector<Figure> SimShares(const std::filesystem::path& program, double seconds);

}  // namespace fovea::bench
