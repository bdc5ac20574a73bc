// The arm's own links stay out of the line of sight from the camera to the target.
//
// With the hand where a target asks for it, another part of the arm may come between: the elbow, or the
// forearm. How near the links' lines come to the line of sight is a limit on the motion like the others
// (motion_limits.hpp).
#pragma once

#include "fovea/model/kinematics.hpp"
#include "fovea/servo/motion_limits.hpp"

namespace fovea::servo {

struct SightConfig {
  double clearance = 0.12;  // of a link's line from the line of sight [m]; 0: nothing is kept
  double rate = 1.5;        // what is left may be used up no faster than exp(-rate t) [1/s]
};

struct Sight {
  const model::ArmPoses& poses;
  const model::Mat6N& J_C;  // body Jacobian of the camera
  model::Pose X_BC;
  model::Vec3 p_BO;  // the target's centre [m]
};

// How far the nearest link's line is from the line of sight, of the links up to the forearm's end [m].
// Real-time: yes.
[[nodiscard]] double ClearanceOfSight(const model::ArmModel& arm, const Sight& sight) noexcept;

// Adds the row for the nearest link. What is already nearer than the clearance may not come nearer still.
// Real-time: yes.
void LimitSight(const SightConfig& config, const model::ArmModel& arm, const Sight& sight,
                MotionLimits& limits) noexcept;

}  // namespace fovea::servo
