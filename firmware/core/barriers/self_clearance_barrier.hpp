// The arm stays away from itself.
//
// Folded up, an arm can run its hand into its shoulder or upper arm. So it is taken as a line (arm_line.hpp),
// of which its thickness is a part of the clearance. The hand is the line from the last joint to the end
// effector, the trunk from the base to the third joint, at the elbow; and the forearm keeps off the base,
// too.
#pragma once

#include "firmware/core/barriers/arm_line.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// How far the hand's line is from the trunk's [m]; HUGE_VAL for an arm of fewer than 6 joints.
// Real-time: yes.
[[nodiscard]] double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept;

// The same as a barrier, which keeps it guard.hand_clearance [m] at least; what is already nearer may not
// come nearer still. None where the clearance is 0, and none where the two cross: there is no way apart then.
// Real-time: yes.
[[nodiscard]] Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                           const ArmLine& line) noexcept;

}  // namespace fovea::barriers
