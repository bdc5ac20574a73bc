// SPDX-License-Identifier: Apache-2.0
// The target's outline in the picture, for display only.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/host/film/overlay.hpp"

namespace fovea::film {

// Points along the outline of the target at `X_CO`, in ideal pixels; of a sphere its silhouette. Empty when a
// part of the outline is not in front of the camera.
Overlay::Curve TargetCurve(const vision::Intrinsics& intrinsics, const features::TargetFeature& target,
                           const model::Pose& X_CO);

// The same at its goal.
inline Overlay::Curve GoalCurve(const vision::Intrinsics& intrinsics, const features::TargetFeature& target) {
  return TargetCurve(intrinsics, target, {target.R_CO_star, target.p_CO_C_star});
}

}  // namespace fovea::film
