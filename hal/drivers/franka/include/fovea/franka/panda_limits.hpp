// SPDX-License-Identifier: Apache-2.0
// The maker's published limits of a Panda; the robot itself does not report them.
#pragma once

#include <array>

#include "fovea/franka/states.hpp"

namespace fovea::franka {

struct PandaJoint {
  double q_min;     // [rad]
  double q_max;     //
  double dq_max;    // [rad/s]
  double ddq_max;   // [rad/s^2]
  double dddq_max;  // [rad/s^3]
  double tau_max;   // [Nm]
};

inline constexpr std::array<PandaJoint, kJoints> kPandaJoints{{
    {-2.8973, 2.8973, 2.1750, 15.0, 7500.0, 87.0},
    {-1.7628, 1.7628, 2.1750, 7.5, 3750.0, 87.0},
    {-2.8973, 2.8973, 2.1750, 10.0, 5000.0, 87.0},
    {-3.0718, -0.0698, 2.1750, 12.5, 6250.0, 87.0},
    {-2.8973, 2.8973, 2.6100, 15.0, 7500.0, 12.0},
    {-0.0175, 3.7525, 2.6100, 20.0, 10000.0, 12.0},
    {-2.8973, 2.8973, 2.6100, 20.0, 10000.0, 12.0},
}};
inline constexpr double kPandaTorqueRate = 1000.0;  // of each joint [Nm/s]
inline constexpr double kPandaHandSpeed = 1.7;      // [m/s]
inline constexpr double kPandaHandRotation = 2.5;   // [rad/s]

}  // namespace fovea::franka
