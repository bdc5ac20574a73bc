// How far an edge is believed that is off the line or curve through the others.
#pragma once

#include <algorithm>
#include <cmath>

namespace fovea::vision {

// Edges are never judged closer than this, whatever their samples say [px, standard deviation].
inline constexpr double kMinScalePx = 0.03;

// Tukey's biweight: 1 at 0, 0 beyond `limit`.
inline double Biweight(double residual, double limit) {
  const double t = residual / limit;
  return std::fabs(t) >= 1.0 ? 0.0 : (1.0 - t * t) * (1.0 - t * t);
}

// Its limit for residuals in standard deviations whose sizes have this median: 1.4826 makes of the median
// what a normal variable's standard deviation would be, never less than it should be; Tukey's constant
// is 4.685 of those.
inline double BiweightLimit(double median_size) { return 4.685 * std::max(1.4826 * median_size, 1.0); }

}  // namespace fovea::vision
