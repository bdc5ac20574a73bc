// SPDX-License-Identifier: Apache-2.0
// The arm's equation of motion: M(q) ddq + C(q, dq) dq + g(q) = tau.
//
// All spatial quantities are taken about the origin of B in axes of B. There a sum over bodies is a plain
// sum, without transforms between neighbours: composite rigid bodies for M (Featherstone, Rigid Body Dynamics
// Algorithms, 2008, ch. 6), recursive Newton-Euler for the rest (ch. 5).
//
// A motor's rotor turns with its joint, faster by the gear's ratio. Its inertia, seen at the joint, is added
// to the diagonal of M (ch. 9.6). The slow turn of its axis with the links, and its gyroscopic torque, are
// left out, as usual for high ratios; its mass is part of the link that carries the motor.
#pragma once

#include "firmware/core/model/kinematics.hpp"

namespace fovea::model {

struct ArmDynamics {
  MatN M;    // [num_joints x num_joints] mass matrix
  VecN Cdq;  // [num_joints] Coriolis and centrifugal torques C(q, dq) dq
  VecN g;    // [num_joints] torques that hold the arm against gravity
};

// Everything at once, for `poses` of the same q and `dq` [num_joints]. Real-time: yes.
void ComputeDynamics(const ArmModel& model, const ArmPoses& poses, const VecN& dq,
                     ArmDynamics& dynamics) noexcept;

// `tau` [num_joints] that gives the arm the acceleration `ddq` [num_joints]. Real-time: yes.
void InverseDynamics(const ArmModel& model, const ArmPoses& poses, const VecN& dq, const VecN& ddq,
                     VecN& tau) noexcept;

}  // namespace fovea::model
