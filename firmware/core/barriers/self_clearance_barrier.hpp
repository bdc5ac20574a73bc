// The arm stays away from itself, and from the planes that its end effector stays above.
//
// Folded up, an arm can run its hand into its shoulder or upper arm; and with the end effector where it may
// be, its elbow or wrist can still come down on the table. So the arm is taken as a line (arm_line.hpp), of
// which its thickness is a part of the clearance. The hand is the line from the last joint to the end
// effector, the trunk from the base to the third joint, at the elbow; and the forearm keeps off the base,
// too. How near they come are limits on the motion like the others (motion_limits.hpp). From the elbow on,
// the fourth joint from the end, no part of the line goes below a plane. The guard proves a stop before each
// of these, too (stop_path.hpp).
#pragma once

#include "firmware/core/barriers/arm_line.hpp"
#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// How far the hand's line is from the trunk's [m]; HUGE_VAL for an arm of fewer than 6 joints.
// Real-time: yes.
[[nodiscard]] double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept;

// Adds the row that keeps the hand's line `clearance` [m] away from the trunk's; what is already nearer may
// not come nearer still. None where `clearance` is 0, and none where the two cross: there is no way apart
// then. Real-time: yes.
void LimitHand(double clearance, const model::ArmModel& arm, const model::ArmPoses& poses,
               const ArmLine& line, MotionLimits& limits) noexcept;

// How far the arm's links from the elbow on, but for the end effector, are from the nearest plane, with
// guard.link_radius about their line [m]; HUGE_VAL without planes. Real-time: yes.
[[nodiscard]] double ClearanceOfPlanes(const model::ArmModel& arm, const config::GuardConfig& guard,
                                       const ArmLine& line) noexcept;

// How far hand, camera, tools and links are from what they keep out of, at least [m]; HUGE_VAL where there is
// nothing. Real-time: yes.
[[nodiscard]] double ClearanceOfArm(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept;

// Adds the row that keeps the links above the plane that they are nearest to, with the speed from which they
// can stop there; what is below may not go further. Real-time: yes.
void LimitArm(const config::ServoConfig& config, const model::ArmPoses& poses, const ArmLine& line,
              MotionLimits& limits) noexcept;

}  // namespace fovea::barriers
