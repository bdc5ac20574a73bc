// What goes wrong with eye, arm, line or person, in thousands of random cases each, and how far the arm goes
// until it stands: the figures of firmware/SAFETY.md.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/closed_loop/guard_bench.hpp"

namespace fovea::test {

// A case: where the arm starts and the target lies, when the hazard begins, and a source of chance for more.
struct HazardCase {
  GuardSetup setup;
  double onset_s = 1.0;
  std::uint64_t seed = 1;
  bool holds = false;  // the person asks for a stop at `onset_s`
};

struct Hazard {
  const char* name;  // for the command line
  const char* what;  // for people
  double watched_s;  // for so long after its beginning
  void (*inject)(HazardCase& hazard_case);
};
std::span<const Hazard> Hazards();

// One case; lengths in mm, shares of the arm's own limits.
struct HazardOutcome {
  bool noticed = false;         // a fault, a mode left, or a measurement refused
  int noticed_ms = 0;           // after its beginning
  double way_mm = 0.0;          // the furthest that the hand was from where it was when the hazard began
  double speed = 0.0;           // its fastest since then [m/s]
  double velocity_share = 0.0;  // of the worst joint since the start
  bool stands = false;          // at the end
  bool touched = false;
};
HazardOutcome RunCase(const Hazard& hazard, std::uint64_t seed);

// Of `cases` cases, by `jobs` threads, whose number changes no figure.
struct HazardFigures {
  int cases = 0;
  int noticed = 0;
  int stand = 0;
  int touched = 0;
  int passed = 0;  // a joint faster than it may be
  int noticed_p99_ms = 0;
  int noticed_most_ms = 0;
  double way_p50_mm = 0.0;
  double way_p99_mm = 0.0;
  double way_most_mm = 0.0;
  double speed_most = 0.0;
  std::uint64_t worst_seed = 0;  // of the longest way
  double joint_most = 0.0;       // of the fastest joint, as a share of its limit
  std::uint64_t joint_seed = 0;
};
HazardFigures RunCases(const Hazard& hazard, int cases, int jobs, std::uint64_t seed,
                       const std::function<void(double share)>& on_progress);

}  // namespace fovea::test
