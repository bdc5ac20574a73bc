// The arm stays away from itself, and from the planes that its end effector stays above.
//
// Folded up, an arm can run its hand into its shoulder or upper arm; and with the end effector where it may
// be, its elbow or wrist can still come down on the table. So the arm is taken as a line (arm_line.hpp), of
// which its thickness is a part of the clearance. The hand is the line from the last joint to the end
// effector, the trunk from the base to the third joint, at the elbow. How near they come are limits on the
// motion like the others (motion_limits.hpp). From the elbow on, the fourth joint from the end, no part of
// the line goes below a plane; the guard proves a stop for the end effector alone.
#pragma once

#include "fovea/model/kinematics.hpp"
#include "fovea/servo/arm_line.hpp"
#include "fovea/servo/motion_limits.hpp"

namespace fovea::servo {

// How far the hand's line is from the trunk's [m]; HUGE_VAL for an arm of fewer than 6 joints.
// Real-time: yes.
[[nodiscard]] double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept;

// Adds the row that keeps the hand's line `clearance` [m] away from the trunk's; what is already nearer may
// not come nearer still. None where `clearance` is 0, and none where the two cross: there is no way apart
// then. Real-time: yes.
void LimitHand(double clearance, const model::ArmModel& arm, const model::ArmPoses& poses,
               const ArmLine& line, MotionLimits& limits) noexcept;

// How far the arm's line from the elbow on, but for the end effector, is from the nearest plane [m]; HUGE_VAL
// without planes. Real-time: yes.
[[nodiscard]] double ClearanceOfPlanes(const model::ArmModel& arm, const Obstacles& obstacles,
                                       const ArmLine& line) noexcept;

// Adds the row that keeps it above that plane; what is below may not go further. Real-time: yes.
void LimitArm(const model::ArmModel& arm, const Obstacles& obstacles, const model::ArmPoses& poses,
              const ArmLine& line, MotionLimits& limits) noexcept;

}  // namespace fovea::servo
