// SPDX-License-Identifier: Apache-2.0
// Whether what runs find out about their servos' beliefs is true, and as sure as they say.
#pragma once

#include <string>
#include <vector>

namespace fovea::findings {

// One belief of one run.
struct Finding {
  bool known = false;
  double difference = 0.0;  // found; in the belief's unit, as the two below
  double sigma = 0.0;       // stated standard deviation of it
  double truth = 0.0;       // drawn
};

struct Coverage {
  int runs = 0;
  int known = 0;
  int within_two_sigma = 0;   // of the known ones
  double sigma_median = 0.0;  // of the known ones; 0 without one
  double sigma_largest = 0.0;
  double error_rms = 0.0;
  double error_largest = 0.0;  // size

  [[nodiscard]] double KnownShare() const;   // 0 without a run
  [[nodiscard]] double WithinShare() const;  // 0 without a known one
};

[[nodiscard]] Coverage CoverageOf(const std::vector<Finding>& findings);

// What is asked of a belief's findings.
struct Goal {
  double sigma_most = 0.0;  // in the belief's unit
  double known_least = 0.95;
  double within_least = 0.90;
  double within_most = 0.99;
};
[[nodiscard]] bool Meets(const Coverage& coverage, const Goal& goal);

}  // namespace fovea::findings
