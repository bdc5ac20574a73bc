// The arm's own links stay out of the lines of sight from the camera to the target: to its centre, or to each
// corner.
//
// With the hand where a target asks for it, another part of the arm may come between: the elbow, or the
// forearm. The hand, and the links with at most ArmShape::kNeighbours joints between them and it, are never
// in its way. How near the others come to the line of sight is a barrier like the others (barrier.hpp).
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

struct Sight {
  const model::ArmPoses& poses;
  const ArmBodies& bodies;
  model::Pose X_BC;  // of the same posture
  features::TargetOutline outline;
  model::Pose X_BO;
};

// How far the nearest link is from the nearest line of sight [m]. Real-time: yes.
[[nodiscard]] double ClearanceOfSight(const Sight& sight) noexcept;

// The same as a barrier, which keeps it guard.sight_clearance [m] at least; what is already nearer may not
// come nearer still. None where the clearance is 0, and none where the two cross: there is no way apart then.
// `J_C`: body Jacobian of the camera. Real-time: yes.
[[nodiscard]] Barrier LineOfSightBarrier(const config::ServoConfig& config, const Sight& sight,
                                         const model::Mat6N& J_C) noexcept;

}  // namespace fovea::barriers
