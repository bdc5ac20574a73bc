// How heavy each joint is where the arm is ready: what gains and motors are chosen by.
#pragma once

#include "firmware/core/model/arm_model.hpp"

namespace fovea::model {

// M_ii of the mass matrix at arm.q_ready [num_joints], loads included [kg m^2, kg]. Real-time: yes.
[[nodiscard]] VecN InertiaAtReady(const ArmModel& arm) noexcept;

}  // namespace fovea::model
