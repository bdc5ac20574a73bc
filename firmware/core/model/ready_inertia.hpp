// SPDX-License-Identifier: Apache-2.0
// The joints' inertia at the ready posture, to check gains and motors.
#pragma once

#include "firmware/core/model/arm_model.hpp"

namespace fovea::model {

// At arm.q_ready, loads included; M is the mass matrix.
struct ReadyInertia {
  VecN held;      // [num_joints] M_ii: inertia of each joint while the others are held [kg m^2, kg]
  VecN coupling;  // [num_joints] M_ii (M^-1)_ii, at least 1: divisor of M_ii while they are free
};

// With a stronger coupling, limits per joint (torque, its rate) deflect the motion from the model's: at 1071,
// with a load beside a wrist, the simulated arm exceeded its limits at rest.
inline constexpr double kCouplingMost = 200.0;

// Real-time: yes.
[[nodiscard]] ReadyInertia InertiaAtReady(const ArmModel& arm) noexcept;

}  // namespace fovea::model
