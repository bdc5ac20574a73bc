// What a simulated run's time goes to, and how it grows, from the timelines of short runs.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// Sums over the spans of one timeline [us].
struct SpanSums {
  double wall_us = 0.0;  // from the first span's begin to the last one's end
  double physics_us = 0.0;
  double servo_us = 0.0;
  double render_us = 0.0;
  double read_back_us = 0.0;
  double sensor_us = 0.0;
  double detection_us = 0.0;
  double logging_us = 0.0;  // what the run's own threads do for log and film
  int ticks = 0;
  int pictures = 0;
};

// Of a file that `fovea-sim run --trace` wrote at lockstep. std::runtime_error when it is none.
SpanSums SumSpans(const std::filesystem::path& file);

// Shares of the wall time of `ball`, which add up to more than one where threads work beside each other; and
// what a step of physics and a picture cost by joints, things and pixels. `program` is fovea-sim.
std::vector<Figure> SimShares(const std::filesystem::path& program, double seconds);

}  // namespace fovea::bench
