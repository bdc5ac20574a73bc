// What pushes the arm from outside, from its momentum (De Luca, Albu-Schaeffer, Haddadin and Hirzinger,
// Collision detection and safe reaction with the DLR-III lightweight manipulator arm, 2006):
//
//   p = M(q) dq,   dp/dt = tau + C(q, dq)^T dq + tau_ext
//   r = K (p - integral of (tau + C^T dq + r))     follows tau_ext with the time constant 1 / K
//
// It needs no acceleration and no torque sensor. C^T dq = dM/dt dq - C dq, with dM/dt from tick to tick. What
// friction the robot's controller leaves is seen as a push, too.
#pragma once

#include "firmware/core/model/dynamics.hpp"

namespace fovea::estimate {

struct ContactState {
  // `carries`: whether a load is carried from the first tick on.
  void Reset(int num_joints, bool carries) noexcept;

  bool started = false;  // false: what the next tick sees is the first; the residual stays as it is
  model::MatN M_before;  // of the tick before
  model::VecN p_before;  // its momentum [Nm s]
  model::VecN residual;  // [num_joints] torques from outside [Nm, N]
  double carried = 1.0;  // share of the load that is carried now, 0 to 1
};

// One tick: `tau` [num_joints] was in force since the tick before, less what the joints' springs pull.
// Real-time: yes.
void ObserveContact(double gain, const model::ArmDynamics& dynamics, const model::VecN& dq,
                    const model::VecN& tau, ContactState& state) noexcept;

// What CarryLoad goes by besides the observer.
struct CarriedLoad {
  const model::ArmModel& arm;
  double stiction_fraction = 0.0;  // of a joint's Coulomb friction may hold it by itself
  double torque_fraction = 0.0;    // of a joint's torque is carried at most
  bool stands = false;             // the arm is to stand; else what it carried is laid down
};

// Adds to `tau` [num_joints] what carries most of the push that the observer sees: an arm that stands gives
// way less to a load that nobody told it of. What friction may hold is left to friction, or the two would
// hunt each other. Real-time: yes.
void CarryLoad(const CarriedLoad& load, ContactState& state, model::VecN& tau) noexcept;

}  // namespace fovea::estimate
