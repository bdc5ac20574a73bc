// Whether any way of the joints leads from one posture to another: a search by two trees that grow towards
// random postures and towards each other (Kuffner and LaValle, RRT-Connect, ICRA 2000).
//
// It shares no code with the servo's own search, and takes its time. What it finds exists; where it finds
// nothing there may still be a way, through a gap too narrow for it.
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
  // A posture near `q` that is nearer to an allowed one; `q` itself will do.
  std::function<model::VecN(const model::VecN& q)> pull;
  double step = 0.1;  // between postures that are asked about [rad]
  int draws = 60000;  // of random postures, until it is given up
};

// The same for the same `seed`. Postures of `goals` that are not allowed are left out, and a start that is
// not has no way.
[[nodiscard]] bool WayExists(const WayProblem& problem, const model::VecN& start,
                             const std::vector<model::VecN>& goals, std::uint64_t seed);

}  // namespace fovea::atlas
