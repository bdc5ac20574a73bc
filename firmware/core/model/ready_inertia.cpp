// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/ready_inertia.hpp"

#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::model {

ReadyInertia InertiaAtReady(const ArmModel& arm) noexcept {
  ArmPoses poses;
  ArmDynamics dynamics;
  ComputePoses(arm, ToVector(arm.q_ready, arm.num_joints), poses);
  ComputeDynamics(arm, poses, VecN::Zero(arm.num_joints), dynamics);
  ReadyInertia ready{dynamics.M.diagonal(), VecN(arm.num_joints)};
  FactorCholesky(dynamics.M);
  for (int i = 0; i < arm.num_joints; ++i) {
    VecN column = VecN::Unit(arm.num_joints, i);
    SolveCholesky(dynamics.M, column);
    ready.coupling[i] = ready.held[i] * column[i];
  }
  return ready;
}

}  // namespace fovea::model
