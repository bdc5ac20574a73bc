// SPDX-License-Identifier: Apache-2.0
// Weight of an edge that is off the line or curve through the others.
#pragma once

#include <algorithm>
#include <cmath>

namespace fovea::vision {

// Least standard deviation of an edge's position, added to the one from its samples [px].
inline constexpr double kMinScalePx = 0.03;

// Tukey's biweight: 1 at 0, 0 beyond `limit`.
inline double Biweight(double residual, double limit) {
  const double t = residual / limit;
  return std::fabs(t) >= 1.0 ? 0.0 : (1.0 - t * t) * (1.0 - t * t);
}

// The biweight's limit for residuals [standard deviations] whose absolute values have this median. 1.4826
// times the median estimates the standard deviation of normal variables, here at least 1. Tukey's constant is
// 4.685.
inline double BiweightLimit(double median_size) { return 4.685 * std::max(1.4826 * median_size, 1.0); }

}  // namespace fovea::vision
