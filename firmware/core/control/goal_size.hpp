// SPDX-License-Identifier: Apache-2.0
// What a feature's error is compared with.
#pragma once

#include <algorithm>

#include "firmware/core/features/feature_state.hpp"

namespace fovea::control {

// The size of the goal, in the feature's own units, at least 0.1: the hybrid feature's goal is 0 in the
// picture's middle at 1 m. Real-time: yes.
[[nodiscard]] inline double GoalSize(const features::FeatureState& feature) noexcept {
  return std::max(feature.s_star.norm(), 0.1);
}

}  // namespace fovea::control
