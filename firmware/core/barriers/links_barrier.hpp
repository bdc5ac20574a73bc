// The arm's links stay above the planes that its end effector stays above.
//
// With the end effector where it may be, the elbow or the wrist can still come down on the table. So the arm
// is taken as a line (arm_line.hpp) with guard.link_radius about it: from the elbow on, the fourth joint from
// the end, no part of it goes below a plane.
#pragma once

#include "firmware/core/barriers/arm_line.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// How far the arm's links from the elbow on, but for the end effector, are from the nearest plane, with
// guard.link_radius about their line [m]; HUGE_VAL without planes. Real-time: yes.
[[nodiscard]] double ClearanceOfPlanes(const model::ArmModel& arm, const config::GuardConfig& guard,
                                       const ArmLine& line) noexcept;

// The same as a barrier: the links come nearer with the speed from which they can stop; what is below may not
// go further. Real-time: yes.
[[nodiscard]] Barrier LinksBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                   const ArmLine& line) noexcept;

}  // namespace fovea::barriers
