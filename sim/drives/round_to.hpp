// SPDX-License-Identifier: Apache-2.0
// Rounding to a converter's steps.
#pragma once

#include <cmath>

namespace fovea::sim {

// The multiple of `quantum` >= 0 that is nearest to `value`, in one unit; `value` itself if `quantum` is 0.
inline double RoundTo(double value, double quantum) {
  return quantum > 0.0 ? quantum * std::round(value / quantum) : value;
}

}  // namespace fovea::sim
