// SPDX-License-Identifier: Apache-2.0
// Starts as pairs of camera poses, as benchmarks of visual servoing with a free camera have them.
//
// The arm's posture at the goal is uniform in the joints' ranges. The target is 0.5 to 0.9 m before the
// camera there, on its axis, tilted by up to 30 degrees and turned by any angle. The camera's start differs
// from its goal by a turn of 2.7 to 180 degrees (half of them below 69) about any axis and by a shift of 13
// to 493 mm (uniform) in any direction: the ranges of the 150 public starts of CNS (arXiv 2309.09047). Turn
// and shift of a start are drawn first. Axis, direction, posture and target are then drawn until the start
// and the goal meet all conditions of a start (sampler.hpp) with one posture each.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/fovea/atlas/sampler.hpp"

namespace fovea::atlas {

struct ViewPair {
  model::Pose X_BC;  // the camera's start, to 1e-5 m and 1e-3 deg
  model::Pose X_BO;  // likewise
  Goal goal;
  double turn = 0.0;   // of the camera, from start to goal [rad]
  double shift = 0.0;  // [m]
  int refused = 0;     // draws before it that were refused
};

// Pair `index` of `seed`. Throws std::runtime_error after a million draws.
[[nodiscard]] ViewPair DrawViewPair(const Scene& scene, std::uint64_t seed, int index);

// A file for --starts, with `pairs` of them. `on_pair` is told after each how many there are, and how many
// draws were refused.
[[nodiscard]] std::string ViewsAsCsv(const Scene& scene, std::uint64_t seed, int pairs,
                                     const std::function<void(int, int)>& on_pair = {});

}  // namespace fovea::atlas
