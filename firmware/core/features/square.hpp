// SPDX-License-Identifier: Apache-2.0
// A square of known side, in two forms.
//
//   four corners   polygon.hpp, dim 8, controls all six degrees of freedom
//   side           s = (x, y, alpha, side), dim 4, as in the exercises: centre or first corner in the
//                  normalised image, the angle of the upper side in it [rad], and that side's length there;
//                  controls x, y, z and the turn about the line of sight; both tilts are free
//
// With a, b the upper side's ends in the image, d = b - a and |d| its length, alpha = atan2(d_y, d_x):
//   d alpha/dt = (d_x d'_y - d_y d'_x) / |d|^2,   d|d|/dt = (d_x d'_x + d_y d'_y) / |d|
//
// Refused if a corner in use has Z below kMinDepth, or the side is shorter than kMinSide in the image.
#pragma once

#include "firmware/core/features/polygon.hpp"

namespace fovea::features {

// Its corners in O: (-a/2, -a/2), (a/2, -a/2), (a/2, a/2), (-a/2, a/2).
[[nodiscard]] Polygon MakeSquare(double side) noexcept;

struct SquareSideFeature {
  static constexpr int kDim = 4;
  static constexpr double kMinSide = 1e-4;  // of the side in the normalised image
  enum class Anchor : std::uint8_t { kCentre, kFirstCorner };

  double side = 0.10;  // [m]
  Anchor anchor = Anchor::kCentre;
  model::Pose X_CO_star{model::Mat3::Identity(), {0.0, 0.0, 0.40}};

  // s's alpha is the one nearest to that of s_star, so that e is never more than half a turn. False, with
  // `state` unchanged, if it is refused. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
