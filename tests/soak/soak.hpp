// SPDX-License-Identifier: Apache-2.0
// A long run in one process, and its findings.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/soak/judge.hpp"

namespace fovea::soak {

struct SoakOptions {
  std::string scenario = "ball";
  std::vector<std::string> assignments;  // key=value, override the scenario
  double hours = 1.0;                    // of robot time
  bool camera = false;                   // render and detect pictures; else features from the truth
  std::uint64_t seed = 1;
  bool late_clock = false;  // clock 30 h before the end of its range, counters near 2^32
  int passes = 2;           // identical runs; they must be bit-identical
  // Called now and then with the progress over all passes [0 to 1].
  std::function<void(double share)> progress;
};

// A figure in the first and in the last tenth.
struct DriftFigure {
  std::string name;
  double first = 0.0;
  double last = 0.0;
  double sigmas = 0.0;
};

struct SoakResult {
  double robot_s = 0.0;
  double wall_s = 0.0;  // of one pass
  std::uint64_t ticks = 0;
  std::uint64_t missed_ticks = 0;
  std::uint64_t heap_calls = 0;  // in ticks
  std::map<std::string, std::uint64_t> endings;
  std::map<std::string, std::uint64_t> troubles;
  std::map<std::string, std::uint64_t> faults;
  std::uint64_t recoveries = 0;
  std::uint64_t ways_home = 0;
  std::uint64_t ways_refused = 0;  // of ways_home, because a limit blocked the path
  double resident_growth = 0.0;    // after warm-up [bytes]
  double heap_growth = 0.0;        // the same, of allocated memory
  std::vector<DriftFigure> drift;
  std::uint64_t digest = 0;  // of modes, faults, limits, reference and torques of every tick, not of stamps
  // Failure messages; empty if the run passed.
  std::vector<std::string> failures;
};

// Throws config::InputError if the scenario cannot be run.
SoakResult RunSoak(const SoakOptions& options);

}  // namespace fovea::soak
