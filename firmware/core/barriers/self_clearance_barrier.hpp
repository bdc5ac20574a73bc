// SPDX-License-Identifier: Apache-2.0
// Keeps the arm's bodies away from each other.
//
// A folded arm can hit its shoulder or upper arm with its hand. Its model (model::ArmShape) lists the pairs
// of bodies that could touch. The barrier uses the nearest pair.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// The smallest gap of all pairs that could touch [m]; negative: they overlap; HUGE_VAL: no pair could.
// Real-time: yes.
[[nodiscard]] double SelfClearance(const model::ArmModel& arm, const ArmBodies& bodies) noexcept;

// The barrier that keeps this gap at least guard.self_clearance [m]. A pair that is already nearer must not
// come nearer still. Inactive if the clearance is 0 or the axes cross: the direction between them is then
// undefined. Real-time: yes.
[[nodiscard]] Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                           const ArmBodies& bodies) noexcept;

}  // namespace fovea::barriers
