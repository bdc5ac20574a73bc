// SPDX-License-Identifier: Apache-2.0
// The corners of a flat target in the normalised image: s = (x_1, y_1, x_2, y_2, ...), two entries each, no
// unit. Square and triangle use it. Three corners control all six degrees of freedom away from their singular
// poses; four do so everywhere, unless the target is seen edge-on.
//
// Refused if a corner's Z is below kMinDepth.
#pragma once

#include <array>

#include "firmware/core/features/point.hpp"

namespace fovea::features {

struct Polygon {
  static constexpr int kMost = 4;

  int num_corners = 0;
  std::array<model::Vec3, kMost> corners{model::Vec3::Zero(), model::Vec3::Zero(), model::Vec3::Zero(),
                                         model::Vec3::Zero()};  // in O, z = 0 [m]

  // Moves the corners so that their mean is the origin, as in frame O.
  void Centre() noexcept;
};

// `state` of `polygon` at `target`, with the goal X_CO = `X_CO_star`. False, with `state` unchanged, if a
// corner is not in front of the camera, here or at the goal, or an argument is not finite. Real-time: yes.
[[nodiscard]] bool ComputeCorners(const Polygon& polygon, const TargetInCamera& target,
                                  const model::Pose& X_CO_star, FeatureState& state) noexcept;

}  // namespace fovea::features
