// SPDX-License-Identifier: Apache-2.0
// Detects leaks and drift of a long run from figures taken during the run.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fovea::soak {

// Memory in use, sampled at equal intervals of robot time.
struct MemorySample {
  double robot_s = 0.0;
  double bytes = 0.0;
};

struct Growth {
  double bytes = 0.0;  // growth of the fitted line from the end of the warm-up to the last sample
  bool leaks = false;
};

// The first tenth of the time is warm-up. A leak is a growth above `most` [bytes] of the least-squares line
// after it. Fewer than 5 samples after the warm-up: no leak.
Growth JudgeMemory(const std::vector<MemorySample>& samples, double most);

// Mean and standard deviation of a figure.
struct Spread {
  std::uint64_t count = 0;
  double mean = 0.0;
  double squares = 0.0;  // sum of (x - mean)^2

  void Add(double x);
  [[nodiscard]] double Sigma() const;
};

// A figure for each tenth of the run.
using Tenths = std::array<Spread, 10>;

struct Drift {
  double sigmas = 0.0;  // between the means of the first and the last tenth (Welch)
  bool drifts = false;
};

// Drift means that the means of the first and the last tenth differ by more than chance. `least` is the
// smallest difference that counts, in units of the figure. Fewer than 8 values in either tenth: no drift.
Drift JudgeDrift(const Tenths& tenths, double least);

}  // namespace fovea::soak
