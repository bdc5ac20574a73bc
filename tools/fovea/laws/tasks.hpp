// SPDX-License-Identifier: Apache-2.0
// The starts on which visual laws are compared: the four canonical tasks (Gans, Hutchinson, Corke,
// Performance tests for visual servo control systems, IJRR 2003), and random ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/fovea/atlas/sampler.hpp"

namespace fovea::laws {

struct Task {
  std::string name;  // "turn by 90 deg"
  bool is_random = false;
  atlas::Start start;
};

struct Tasks {
  std::vector<Task> tasks;           // the canonical ones, then the random ones
  std::vector<std::string> skipped;  // canonical ones whose start the arm cannot take
};

// A square looks the same after a quarter turn, so its canonical turns end at 45 degrees.
Tasks TasksFor(const atlas::Scene& scene, int random, std::uint64_t seed);

}  // namespace fovea::laws
