// SPDX-License-Identifier: Apache-2.0
// Makes a found path short and smooth.
#pragma once

#include "firmware/planning/path_search.hpp"

namespace fovea::planning {

// The length of `path` [rad].
[[nodiscard]] double LengthOf(const PostureSpace& space, const Polyline& path) noexcept;

class PathShortener {
 public:
  PathShortener();

  // Replaces parts of `path` by straight motions, and by motions that keep the target in the picture, where
  // they are free and shorter. Uses at most `most_work`, about.
  void Shorten(const PostureSpace& space, int most_work, Work& work, Draws& draws, Polyline& path) noexcept;

  // Replaces the corners of `path` by `points` ones that are equally far apart along it, its ends included.
  void Resample(const PostureSpace& space, int points, Polyline& path) noexcept;

 private:
  [[nodiscard]] bool GoInView(const PostureSpace& space, const model::VecN& from, const model::VecN& to,
                              double most, Work& work) noexcept;

  Polyline part_;
};

// Moves each corner of an evenly spaced `path` towards the middle of its neighbours, where that is free. Its
// edges are not tested again. `sweeps`: number of times.
void Straighten(const PostureSpace& space, int sweeps, Work& work, Polyline& path) noexcept;

}  // namespace fovea::planning
