// What the servo itself does against friction and springs in the joints: a torque that makes up for them.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "firmware/core/trajectory/reference.hpp"

namespace fovea::motion_laws {

// -1 to 1 with the sign of `v`, without a jump: v / sqrt(v^2 + width^2). Real-time: yes.
[[nodiscard]] double SmoothSign(double v, double width) noexcept;

// The share config.friction_compensation of the joints' friction: viscous by the measured speed `dq`, Coulomb
// by its sign. Near standstill, where that sign means nothing, the reference's own is taken: so the joint is
// torn off when it shall turn round, and left alone when it shall stand. [num_joints] Real-time: yes.
[[nodiscard]] model::VecN FrictionTorque(const model::ArmModel& arm, const config::MotionLawConfig& config,
                                         const trajectory::Reference& reference,
                                         const model::VecN& dq) noexcept;

// What the joints' springs pull at `q`, to be made up for. [num_joints] Real-time: yes.
[[nodiscard]] model::VecN SpringTorque(const model::ArmModel& arm, const model::VecN& q) noexcept;

}  // namespace fovea::motion_laws
