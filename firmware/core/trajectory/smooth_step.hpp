// SPDX-License-Identifier: Apache-2.0
// A smooth transition from 0 to 1.
#pragma once

namespace fovea::trajectory {

// 0 below 0, 1 above 1, between them 3 x^2 - 2 x^3, with zero slope at both ends. Real-time: yes.
[[nodiscard]] inline double SmoothStep(double x) noexcept {
  if (x >= 1.0) {
    return 1.0;
  }
  return x <= 0.0 ? 0.0 : x * x * (3.0 - 2.0 * x);
}

}  // namespace fovea::trajectory
