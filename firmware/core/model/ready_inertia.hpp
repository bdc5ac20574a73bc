// How heavy each joint is where the arm is ready: what gains and motors are chosen by.
#pragma once

#include "firmware/core/model/arm_model.hpp"

namespace fovea::model {

// At arm.q_ready, loads included; M is the mass matrix.
struct ReadyInertia {
  VecN held;      // [num_joints] M_ii: of each joint while the others are held [kg m^2, kg]
  VecN coupling;  // [num_joints] M_ii (M^-1)_ii, at least 1: how many times less while they are free
};

// Of an arm that is coupled more closely, limits per joint (torque, its rate) bend the motion to where the
// model does not send it: at 1071 times, with a load beside a wrist, the simulated arm passed its limits at
// rest.
inline constexpr double kCouplingMost = 200.0;

// Real-time: yes.
[[nodiscard]] ReadyInertia InertiaAtReady(const ArmModel& arm) noexcept;

}  // namespace fovea::model
