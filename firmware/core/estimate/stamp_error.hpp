// SPDX-License-Identifier: Apache-2.0
// The error that all stamps of a camera have in common: its latency is not the configured one.
//
// While the camera moves, pictures with wrong stamps make a still target seem to move, and a servo that
// follows this motion makes it larger. Each filter of the target therefore also estimates by how much the
// pictures are older than their stamps, from what the camera's own motion explains (a nuisance parameter;
// Bar-Shalom, Li, Kirubarajan, section 11.9). With an image velocity s' the pictures seem off by -late s'
// (THEORY H).
#pragma once

#include <algorithm>

namespace fovea::estimate {

inline constexpr double kLateDrift = 1e-6;  // the latency may change by a millisecond within a second [s^2/s]

// How much older than their stamps the pictures are.
struct StampError {
  double mean_s = 0.0;
  double sigma_s = 0.0;
};

// Keeps the estimate within what the configured standard deviation of stamps makes credible. Real-time: yes.
inline double CredibleLateness(double late, double stamp_sigma) noexcept {
  constexpr double kMostSigmas = 3.0;
  return std::clamp(late, -kMostSigmas * stamp_sigma, kMostSigmas * stamp_sigma);
}

}  // namespace fovea::estimate
