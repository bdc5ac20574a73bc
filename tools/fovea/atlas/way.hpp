// SPDX-License-Identifier: Apache-2.0
// Searches a joint path from one posture to another with two trees that grow towards random postures and
// towards each other (Kuffner and LaValle, RRT-Connect, ICRA 2000).
//
// It shares no code with the servo's own search, and may take long. A path that it finds exists. When it
// finds none, a path through a narrow gap may still exist.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "firmware/core/model/types.hpp"

namespace fovea::atlas {

struct WayProblem {
  model::VecN least;  // of the joints' ranges [num_joints]
  model::VecN most;
  std::function<bool(const model::VecN& q)> is_allowed;
  // Returns a posture near `q` that is closer to an allowed one, or `q` itself.
  std::function<model::VecN(const model::VecN& q)> pull;
  double step = 0.1;  // between tested postures [rad]
  int draws = 60000;  // largest number of random postures
};

struct WayResult {
  bool found = false;
  double length = 0.0;  // of the path, after shortcuts [rad]
  int draws = 0;        // random postures that were drawn
};

// Searches a path to any of `goals`. The same seed gives the same result. Goals that are not allowed are
// ignored. From a start that is not allowed there is no path.
[[nodiscard]] WayResult FindWay(const WayProblem& problem, const model::VecN& start,
                                const std::vector<model::VecN>& goals, std::uint64_t seed);

}  // namespace fovea::atlas
