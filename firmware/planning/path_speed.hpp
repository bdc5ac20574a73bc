// SPDX-License-Identifier: Apache-2.0
// How fast the arm may run along a path: the fastest speed within the joints' velocity and acceleration
// limits, the hand's speed limits and all barriers.
//
// The path is cut into cells, in which q'' and d2u/dt2 are constant. So x = (du/dt)^2 is linear in a cell,
// and
//
//   |q' sqrt(x)| <= V,   |q'' x + q' dx/du / 2| <= A,   x <= cap
//
// need only be kept at the cell's ends. A pass from the end finds the largest x from which the rest of the
// path can be done, a pass from the start the largest x that can be reached: the fastest motion (Pham and
// Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE T-RO 2018).
// Jerk is not bounded here (time_path.hpp).
#pragma once

#include <vector>

#include "firmware/core/trajectory/velocity_change.hpp"
#include "firmware/planning/smooth_path.hpp"

namespace fovea::planning {

using JointLimits = std::array<trajectory::AxisLimits, model::kMaxJoints>;

class PathSpeed {
 public:
  static constexpr int kCellsInPiece = 4;

  // `most_corners`: of a path. `limits` must outlive this.
  PathSpeed(const JointLimits& limits, int most_corners);

  // Cuts `path` into cells and computes each cell end's largest speed from the tick's own limits there.
  void Begin(const PostureSpace& space, const SmoothPath& path, Work& work) noexcept;

  // Computes the fastest motion. Its duration [s]; HUGE_VAL if there is none.
  [[nodiscard]] double Run() noexcept;
  // Lowers the largest speeds near `u` to `share` of the present motion's.
  void SlowDown(double u, double share) noexcept;

  // u `t` seconds after the start of the present motion, in increasing order of calls from `cell`, 0 at
  // first.
  [[nodiscard]] double UAt(double t, std::size_t& cell) const noexcept;

 private:
  struct Knot {
    double u = 0.0;
    model::VecN slope;
    double x_cap = 0.0;
    double x = 0.0;  // of the present motion
    double t = 0.0;
  };
  // The largest x at the begin of `cell` from which an x of at most `x_end_most` can be reached at its end.
  [[nodiscard]] double MostBefore(std::size_t cell, double x_end_most) const noexcept;
  // The largest x at the end of `cell`, at most `x_end_most`; below 0 if there is none.
  [[nodiscard]] double MostAfter(std::size_t cell, double x_begin, double x_end_most) const noexcept;

  const JointLimits& limits_;
  std::vector<Knot> knots_;
  std::vector<model::VecN> bends_;  // of each cell
};

}  // namespace fovea::planning
