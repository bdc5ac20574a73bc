// The arm's links stay above the planes that its hand stays above.
//
// With the hand where it may be, the elbow or the wrist can still come down on the table. None of the last
// four links does: of an arm with six or seven joints these are forearm, wrist and hand. The links before
// them cannot reach what the base stands on, and stand beside a wall as the base does.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

inline constexpr int kOuterLinks = 4;  // that planes are for

// How far the arm's links are from the nearest plane [m]; HUGE_VAL without planes. Real-time: yes.
[[nodiscard]] double ClearanceOfPlanes(const config::GuardConfig& guard, const ArmBodies& bodies) noexcept;

// The same as a barrier, which keeps it guard.link_clearance [m] and more: the links come nearer with the
// speed from which they can stop; what is nearer may not go further. Real-time: yes.
[[nodiscard]] Barrier LinksBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                   const ArmBodies& bodies) noexcept;

}  // namespace fovea::barriers
