// SPDX-License-Identifier: Apache-2.0
// The error that all stamps of a camera have in common: its latency is not the configured one.
//
// While the camera moves, pictures with wrong stamps make a still target seem to move, and a servo that
// follows this motion makes it larger. Each filter of the target therefore also estimates by how much the
// pictures are older than their stamps, from what the camera's own motion explains (a nuisance parameter;
// Bar-Shalom, Li, Kirubarajan, section 11.9). With an image velocity s' the pictures seem off by -late s'
// (THEORY H).
//
// It belongs to the camera: what one target has shown of it holds for the next one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fovea/hal/types.hpp"

namespace fovea::estimate {

// How much older than their stamps the pictures are.
struct StampError {
  double mean_s = 0.0;
  double sigma_s = 0.0;
};

inline constexpr double kMostStampSigmas = 3.0;  // of servo.stamp_sigma: an error that is credible

// The variance [s^2] of the common error `dt` [s] later: the latency may change by a millisecond within a
// second, but is never less certain than before the first picture. Real-time: yes.
inline double DriftedVariance(double variance, double dt, double stamp_sigma) noexcept {
  constexpr double kDrift = 1e-6;  // [s^2/s]
  return std::max(variance, std::min(variance + dt * kDrift, stamp_sigma * stamp_sigma));
}

// Keeps the estimate within what the configured mean and standard deviation of stamps make credible.
//
// This is all that servo.stamp_offset does to a filter that runs. The filter's lateness is the whole one,
// with the offset, so a learnt offset that comes in is not corrected twice and the target does not jump: it
// moves the range of what is credible, and it is what a filter begins with that has forgotten its target.
// Real-time: yes.
inline double CredibleLateness(double late, double stamp_offset, double stamp_sigma) noexcept {
  return std::clamp(late, stamp_offset - kMostStampSigmas * stamp_sigma,
                    stamp_offset + kMostStampSigmas * stamp_sigma);
}

// What was found of the common error, at `stamp_ns`.
struct LearntLateness {
  bool known = false;  // a target has been seen
  std::int64_t stamp_ns = 0;
  StampError error;
};

// The common error at `now_ns`, without a target. Real-time: yes.
inline StampError LatenessAt(const LearntLateness& learnt, std::int64_t now_ns, double stamp_offset,
                             double stamp_sigma) noexcept {
  if (!learnt.known) {
    return {stamp_offset, stamp_sigma};
  }
  const double variance = learnt.error.sigma_s * learnt.error.sigma_s;
  const double dt = std::max(hal::ToSeconds(now_ns - learnt.stamp_ns), 0.0);
  return {CredibleLateness(learnt.error.mean_s, stamp_offset, stamp_sigma),
          std::sqrt(DriftedVariance(variance, dt, stamp_sigma))};
}

}  // namespace fovea::estimate
