// SPDX-License-Identifier: Apache-2.0
// Keeps the arm's links above the planes that limit its hand.
//
// While the hand is clear, the elbow or the wrist can still hit the table. The barrier covers the last four
// links: forearm, wrist and hand of an arm with six or seven joints. The links before them cannot reach the
// surface that the base stands on, and are as clear of a wall as the base is.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

inline constexpr int kOuterLinks = 4;  // the barrier covers these last links

// The smallest distance of these links from a plane [m]; HUGE_VAL without planes. Real-time: yes.
[[nodiscard]] double ClearanceOfPlanes(const config::GuardConfig& guard, const ArmBodies& bodies) noexcept;

// The barrier that keeps this distance above guard.link_clearance [m] plus twice the workspace margin. The
// links approach no faster than they can stop. A link that is already nearer must not come nearer still.
// Real-time: yes.
[[nodiscard]] Barrier LinksBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                   const ArmBodies& bodies) noexcept;

}  // namespace fovea::barriers
