// What pushes the arm from outside, from its momentum (De Luca, Albu-Schaeffer, Haddadin and Hirzinger,
// Collision detection and safe reaction with the DLR-III lightweight manipulator arm, 2006):
//
//   p = M(q) dq,   dp/dt = tau + C(q, dq)^T dq + tau_ext
//   r = K (p - integral of (tau + C^T dq + r))     follows tau_ext with the time constant 1 / K
//
// It needs no acceleration and no torque sensor. C^T dq = dM/dt dq - C dq, with dM/dt from tick to tick. What
// friction the robot's controller leaves is seen as a push, too.
#pragma once

#include "fovea/model/dynamics.hpp"

namespace fovea::servo {

struct ContactState {
  bool started = false;  // false: what the next tick sees is the first; the residual stays as it is
  model::MatN M_before;  // of the tick before
  model::VecN p_before;  // its momentum [Nm s]
  model::VecN residual;  // [num_joints] torques from outside [Nm, N]
};

// One tick: `tau` [num_joints] was in force since the tick before. Real-time: yes.
void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept;

}  // namespace fovea::servo
