// A line through the edges of one side of a polygon, of which some may be another thing's.
#pragma once

#include <Eigen/Core>
#include <span>

namespace fovea::vision {

// An edge on one of the lines across a side.
struct SideEdge {
  double t = 0.0;         // where along the side, -1 to 1
  double at_px = 0.0;     // how far outward
  double variance = 0.0;  // of it [px^2]
  bool rounded = false;   // by the corner beside it: that it is off the line says nothing
  double weight = 0.0;    // out: how far it was believed, 0 to 1
  bool left_out = false;  // out: it, or an edge near to it, is not the side's
  bool off = false;       // out: it is not on the line
};

// at_px = a + b t.
struct SideLine {
  double a = 0.0;
  double b = 0.0;
  Eigen::Matrix2d cov = Eigen::Matrix2d::Zero();  // by what the edges scatter [px^2]
  double middle = 0.0;                            // t in the middle of the edges that were believed
  double spread = 0.0;                            // their standard deviation about it
  double on = 0.0;                                // share of the edges that are on the line
};

// Robust weighted least squares from `line`'s a and b; where those do not fit most edges, from the line that
// most agree on. Some edges in a row that are off it are another thing's: they are left out, and `beside` on
// both sides of them, which that thing may move. False when too few agree.
bool FitSideLine(std::span<SideEdge> edges, int beside, SideLine& line);

}  // namespace fovea::vision
