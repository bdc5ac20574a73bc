// SPDX-License-Identifier: Apache-2.0
// Estimates the external torques on the arm from its momentum (De Luca, Albu-Schaeffer, Haddadin and
// Hirzinger, Collision detection and safe reaction with the DLR-III lightweight manipulator arm, 2006):
//
//   p = M(q) dq,   dp/dt = tau + C(q, dq)^T dq + tau_ext
//   r = K (p - integral of (tau + C^T dq + r))     follows tau_ext with the time constant 1 / K
//
// It needs no acceleration and no torque sensor. C^T dq = dM/dt dq - C dq, with dM/dt as the difference of
// two ticks. Friction that the robot's controller does not compensate also appears as an external torque.
#pragma once

#include "firmware/core/model/dynamics.hpp"

namespace fovea::estimate {

struct ContactState {
  // `carries`: true to compensate a load from the first tick on.
  void Reset(int num_joints, bool carries) noexcept;

  bool started = false;  // false: the next tick is the first one; the residual stays as it is
  model::MatN M_before;  // of the previous tick
  model::VecN p_before;  // its momentum [Nm s]
  model::VecN residual;  // [num_joints] external torques [Nm, N]
  double carried = 1.0;  // share of the load that is compensated now, 0 to 1
};

// One tick. `tau` [num_joints]: the torques in force since the previous tick, less those of the joints'
// springs. Real-time: yes.
void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept;

// What CarryLoad uses besides the observer.
struct CarriedLoad {
  const model::ArmModel& arm;
  double stiction_fraction = 0.0;  // of a joint's Coulomb friction: may hold the joint by itself
  double torque_fraction = 0.0;    // of a joint's torque: compensated at most
  bool stands = false;             // the arm stands; if not, the compensation fades out
};

// Adds to `tau` [num_joints] the compensation of most of the observed external torque, so that a standing arm
// yields less to an unknown load. It omits the part that friction may hold; otherwise servo and friction
// would cause a limit cycle. Real-time: yes.
void CarryLoad(const CarriedLoad& load, ContactState& state, model::VecN& tau) noexcept;

}  // namespace fovea::estimate
