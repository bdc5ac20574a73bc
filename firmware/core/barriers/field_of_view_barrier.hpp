// A limit on the motion that keeps the target in the picture: what the camera does not see it cannot follow.
//
// For each of the picture's four sides the point of the target that is nearest to it may approach it only so
// fast, d x/dt <= rate (x_max - x), and past it no further. Standing still is always allowed, also where the
// target runs out of the picture by itself: its own motion counts, as far as the camera can make up for it.
#pragma once

#include <array>

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// The target as it is kept in the picture.
struct ViewedTarget {
  features::TargetOutline outline;
  features::TargetInCamera seen;
  const model::Mat6N& J_C;                     // body Jacobian of the camera
  model::Vec3 normal_C = model::Vec3::Zero();  // of a disc, where it is known; else 0
};

// One for each side of the picture; none of them when the picture's limits are not enabled, or a point of the
// target is not well before the camera. Real-time: yes.
using PictureBarriers = std::array<Barrier, 4>;
[[nodiscard]] PictureBarriers FieldOfViewBarriers(const config::GuardConfig& guard,
                                                  const ViewedTarget& target) noexcept;

}  // namespace fovea::barriers
