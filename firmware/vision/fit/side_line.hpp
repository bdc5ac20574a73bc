// SPDX-License-Identifier: Apache-2.0
// A line through the edges of one side of a polygon; some edges may belong to another object.
#pragma once

#include <Eigen/Core>
#include <span>

namespace fovea::vision {

// An edge on one of the lines across a side.
struct SideEdge {
  double t = 0.0;         // position along the side, -1 to 1
  double at_px = 0.0;     // position outward
  double variance = 0.0;  // of at_px [px^2]
  bool rounded = false;   // by the corner beside it, so it may be off the line
  double weight = 0.0;    // out: weight in the fit, 0 to 1
  bool left_out = false;  // out: it, or an edge near it, belongs to another object
  bool off = false;       // out: it is not on the line
};

// at_px = a + b t.
struct SideLine {
  double a = 0.0;
  double b = 0.0;
  Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();  // of (a, b), from the scatter of the edges [px^2]
  double middle = 0.0;                            // weighted mean of t
  double spread = 0.0;                            // weighted standard deviation of t
  double on = 0.0;                                // share of the edges that are on the line
};

// Robust weighted least squares from `line`'s a and b; if these do not fit most edges, from the line that
// most edges agree with. A run of edges off the line belongs to another object: it is left out, with `beside`
// edges on both sides, which that object may shift. False if too few edges agree.
bool FitSideLine(std::span<SideEdge> edges, int beside, SideLine& line);

}  // namespace fovea::vision
