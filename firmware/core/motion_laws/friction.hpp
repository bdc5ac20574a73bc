// SPDX-License-Identifier: Apache-2.0
// Torques by which the servo itself compensates friction and springs in the joints.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "firmware/core/trajectory/reference.hpp"

namespace fovea::motion_laws {

// -1 to 1 with the sign of `v`, without a jump: v / sqrt(v^2 + width^2). Real-time: yes.
[[nodiscard]] double SmoothSign(double v, double width) noexcept;

// The share config.friction_compensation of the joints' friction [num_joints]: viscous by the measured speed
// `dq`, Coulomb by its sign. Near standstill, where that sign is meaningless, the reference's sign counts: it
// breaks a joint loose that reverses, and does not disturb one that stands. Real-time: yes.
[[nodiscard]] model::VecN FrictionTorque(const model::ArmModel& arm, const config::MotionLawConfig& config,
                                         const trajectory::Reference& reference,
                                         const model::VecN& dq) noexcept;

// The torques that compensate the joints' springs at `q` [num_joints]. Real-time: yes.
[[nodiscard]] model::VecN SpringTorque(const model::ArmModel& arm, const model::VecN& q) noexcept;

}  // namespace fovea::motion_laws
