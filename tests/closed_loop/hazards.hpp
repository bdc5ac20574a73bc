// SPDX-License-Identifier: Apache-2.0
// Hazards of camera, arm, line, computer and person, each in thousands of random cases: how far the arm moves
// until it stands. These are the figures of firmware/SAFETY.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/closed_loop/guard_bench.hpp"

namespace fovea::test {

// A case: the arm's start, the target's position, when the hazard begins, and a seed for further values.
struct HazardCase {
  GuardSetup setup;
  double onset_s = 1.0;
  std::uint64_t seed = 1;
  bool holds = false;  // the operator requests Hold at `onset_s`
};

struct Hazard {
  const char* name;  // for the command line
  const char* what;  // for the table
  double watched_s;  // from its beginning [s]
  void (*inject)(HazardCase& hazard_case);
};
std::span<const Hazard> Hazards();

// The outcome of one case. Shares are of the limits of the arm model.
struct HazardOutcome {
  bool noticed = false;         // by a fault, a change of mode or a refused measurement
  int noticed_ms = 0;           // after the hazard began
  double way_mm = 0.0;          // largest distance of the hand from where it was when the hazard began
  double speed = 0.0;           // of the hand, the largest since then [m/s]
  double velocity_share = 0.0;  // of a joint's velocity limit, the largest since the start
  bool stands = false;          // at rest at the end
  bool touched = false;         // contact since the hazard began
};
HazardOutcome RunCase(const Hazard& hazard, std::uint64_t seed);

// Runs `cases` cases in `jobs` threads. The number of threads changes no figure.
struct HazardFigures {
  int cases = 0;
  int noticed = 0;
  int stand = 0;
  int touched = 0;
  int passed = 0;  // cases with a joint above its velocity limit
  int noticed_p99_ms = 0;
  int noticed_most_ms = 0;
  double way_p50_mm = 0.0;
  double way_p99_mm = 0.0;
  double way_most_mm = 0.0;
  double speed_most = 0.0;
  std::uint64_t worst_seed = 0;  // of the case with the longest way
  double joint_most = 0.0;       // of the fastest joint, as a share of its limit
  std::uint64_t joint_seed = 0;
};
HazardFigures RunCases(const Hazard& hazard, int cases, int jobs, std::uint64_t seed,
                       const std::function<void(double share)>& on_progress);

}  // namespace fovea::test
