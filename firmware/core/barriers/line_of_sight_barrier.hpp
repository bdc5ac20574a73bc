// SPDX-License-Identifier: Apache-2.0
// Keeps the arm's own links and the known boxes out of the lines of sight from the camera to the target's
// centre or its corners.
//
// When the hand tracks a target, the elbow or the forearm may come between camera and target. The hand, and
// the links with at most ArmShape::kNeighbours joints between them and the hand, never do. The distance of
// the other links and of boxes from the line of sight is a barrier (barrier.hpp). A box may be near the last
// tenth of a line, so that a target can lie beside or on one.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// A link's housing, which the camera sees, is wider than its capsule by up to this [m].
inline constexpr double kHousing = 0.02;

struct Sight {
  const model::ArmPoses& poses;
  const ArmBodies& bodies;
  model::Pose X_BC;  // at the posture of `poses`
  features::TargetOutline outline;
  model::Pose X_BO;
  const config::Obstacles& obstacles;
};

// The smallest distance of a link's housing or a box from a line of sight [m]. Real-time: yes.
[[nodiscard]] double ClearanceOfSight(const Sight& sight) noexcept;

// The barrier that keeps this distance at least guard.sight_clearance [m]. What is already nearer must
// not come nearer still. Inactive if the clearance is 0 or a link's axis crosses: the direction between them
// is then undefined. `J_C`: body Jacobian of the camera. Real-time: yes.
[[nodiscard]] Barrier LineOfSightBarrier(const config::ServoConfig& config, const Sight& sight,
                                         const model::Mat6N& J_C) noexcept;

}  // namespace fovea::barriers
