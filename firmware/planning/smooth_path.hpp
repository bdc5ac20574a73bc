// SPDX-License-Identifier: Apache-2.0
// A path with continuous direction through the neighbourhood of control points: a quadratic B-spline.
//
// Parabola i runs from the middle of one edge to the middle of the next, tangent to both. With corner P_i and
// edges e_(i-1), e_i at it, and u from 0 to 1,
//
//   q' = (1 - u) e_(i-1) + u e_i,   q'' = e_i - e_(i-1)
//
// so q' is linear and q'' constant in each piece, which makes the bounds of timing exact. A half of the first
// and of the last edge, straight, begin and end it. A corner is cut by |e_i - e_(i-1)| / 8.
#pragma once

#include "firmware/planning/path_search.hpp"

namespace fovea::planning {

class SmoothPath {
 public:
  // `corners`: at least two. The path holds no copy: they must outlive it.
  explicit SmoothPath(const Polyline& corners) noexcept : corners_(corners) {}

  // u goes from 0 to End(), one unit for each edge.
  [[nodiscard]] double End() const noexcept { return static_cast<double>(corners_.size() - 1); }
  [[nodiscard]] model::VecN At(double u) const noexcept;
  // q' = dq/du at `u`.
  [[nodiscard]] model::VecN Slope(double u) const noexcept;
  // q'' inside the piece that contains `u`, which is not at an end of a piece.
  [[nodiscard]] model::VecN Bend(double u) const noexcept;

 private:
  [[nodiscard]] model::VecN Edge(std::size_t i) const noexcept { return corners_[i + 1] - corners_[i]; }

  const Polyline& corners_;
};

}  // namespace fovea::planning
