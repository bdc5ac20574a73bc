// SPDX-License-Identifier: Apache-2.0
// What a fit must reach to be accepted as the target, whatever the target's shape is.
#pragma once

#include <algorithm>

namespace fovea::vision {

inline constexpr double kMinColourShare = 0.6;  // share of the inside that must have the target's colour
inline constexpr double kSureConfidence = 0.9;  // above it no other candidate is tried

// Largest rms distance of the edges from the outline [px], in a picture with this noise. Capped at a share of
// the radius: other shapes scatter more.
inline double MostRmsPx(double noise_px, double radius_px) {
  constexpr double kMaxRmsPx = 0.35;
  constexpr double kMaxRmsShare = 0.05;
  return std::min(kMaxRmsPx + 1.3 * noise_px, std::max(kMaxRmsPx, kMaxRmsShare * radius_px));
}

}  // namespace fovea::vision
