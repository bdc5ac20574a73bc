// SPDX-License-Identifier: Apache-2.0
// What the end effector carries: the camera, a tool, a workpiece.
#pragma once

#include "firmware/core/model/arm_model.hpp"
#include "firmware/core/model/dynamics.hpp"

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

// A mass at a point of the end effector. It may be negative: a load that is lighter than believed.
struct PointMass {
  double mass = 0.0;        // [kg]
  Vec3 p_E = Vec3::Zero();  // [m]
};

// Adds what `extra` does to `dynamics`, which are those of `arm` without it, at the same `poses` and `dq`.
// Real-time: yes.
void AddPointMass(const ArmModel& arm, const ArmPoses& poses, const VecN& dq, const PointMass& extra,
                  ArmDynamics& dynamics) noexcept;

// The torques [num_joints] that hold `extra` against gravity. Real-time: yes.
[[nodiscard]] VecN HoldingTorque(const ArmModel& arm, const ArmPoses& poses, const PointMass& extra) noexcept;

}  // namespace fovea::model
