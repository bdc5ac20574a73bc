// SPDX-License-Identifier: Apache-2.0
// What the end effector carries: the camera, a tool, a workpiece.
#pragma once

#include "firmware/core/model/arm_model.hpp"

namespace fovea::model {

struct Load {
  double mass = 0.0;            // [kg]; 0: nothing is carried
  Vec3 p_ECom = Vec3::Zero();   // centre of mass in E [m]
  Mat3 I_Com_E = Mat3::Zero();  // about the centre of mass, in axes of E [kg m^2]
};

// Joins two bodies that are fixed to each other, all in one frame; the sum of their masses is above 0.
// Real-time: yes.
[[nodiscard]] LinkInertia Join(const LinkInertia& a, const LinkInertia& b) noexcept;

// Adds `load` to the last link of `arm`. Real-time: yes.
void Attach(const Load& load, ArmModel& arm) noexcept;

}  // namespace fovea::model
