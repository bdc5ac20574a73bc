// The arm stays away from itself.
//
// Folded up, an arm can run its hand into its shoulder or upper arm. Its model (model::ArmShape)
// names the pairs of its bodies that could touch. The pair that is nearest counts.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// The least gap between two links that could touch [m]; negative: they overlap; HUGE_VAL where none could.
// Real-time: yes.
[[nodiscard]] double SelfClearance(const model::ArmModel& arm, const ArmBodies& bodies) noexcept;

// The same as a barrier, which keeps it guard.self_clearance [m] at least; what is already nearer may not
// come nearer still. None where the clearance is 0, and none where two axes cross: there is no way apart
// then. Real-time: yes.
[[nodiscard]] Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                                           const ArmBodies& bodies) noexcept;

}  // namespace fovea::barriers
