// Whether a long run leaks or drifts: judged from figures taken while it went on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fovea::soak {

// How much of the system's memory there was, taken at equal distances of robot time.
struct MemorySample {
  double robot_s = 0.0;
  double bytes = 0.0;
};

struct Growth {
  double bytes = 0.0;  // of the straight line through the samples, from the end of the warm-up to the last
  bool leaks = false;
};

// The first tenth of the time is warm-up. `most`: what may come on top of it [bytes], by the straight line
// that fits best. Fewer than 5 samples after the warm-up tell nothing: no leak.
Growth JudgeMemory(const std::vector<MemorySample>& samples, double most);

// Mean and deviation of a figure.
struct Spread {
  std::uint64_t count = 0;
  double mean = 0.0;
  double squares = 0.0;  // sum of (x - mean)^2

  void Add(double x);
  [[nodiscard]] double Sigma() const;
};

// A figure of each of the run's tenths.
using Tenths = std::array<Spread, 10>;

struct Drift {
  double sigmas = 0.0;  // between the means of the first and the last tenth (Welch)
  bool drifts = false;
};

// The same distribution in the first and the last tenth: their means apart by chance alone. `least` is the
// smallest difference that counts, in units of the figure. Fewer than 8 values in one of them tell nothing.
Drift JudgeDrift(const Tenths& tenths, double least);

}  // namespace fovea::soak
