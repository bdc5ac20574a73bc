// SPDX-License-Identifier: Apache-2.0
// A motion limit that keeps the target in the picture, because the servo cannot follow a target out of view.
//
// For each of the picture's four sides, the nearest point of the target may approach that side only with
// dx/dt <= rate (x_max - x), and must not move further out beyond it. The target's own motion counts, as far
// as the camera can compensate it. Standing still is always allowed, even if the target leaves the picture.
#pragma once

#include <array>

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// The target, as these barriers use it.
struct ViewedTarget {
  features::TargetOutline outline;
  features::TargetInCamera seen;
  const model::Mat6N& J_C;                     // body Jacobian of the camera
  model::Vec3 normal_C = model::Vec3::Zero();  // of a disc, if known; else 0
};

// One barrier for each side of the picture. All are inactive if the picture's limits are disabled or a point
// of the target is not clearly in front of the camera. Real-time: yes.
using PictureBarriers = std::array<Barrier, 4>;
[[nodiscard]] PictureBarriers FieldOfViewBarriers(const config::GuardConfig& guard,
                                                  const ViewedTarget& target) noexcept;

// The same for a motion along a plan, which is known to turn before the edge: it may come near it faster,
// with a rate of 8 1/s or more, from which the arm can still stop.
[[nodiscard]] PictureBarriers FieldOfViewBarriersOnPlan(const config::GuardConfig& guard,
                                                        const ViewedTarget& target) noexcept;

}  // namespace fovea::barriers
