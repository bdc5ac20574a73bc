// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"

namespace fovea::motion_laws {

using model::Mat6;
using model::Mat6N;
using model::MatN;
using model::Vec6;
using model::VecN;

void OperationalSpace(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                      MotionLawState& /*state*/, VecN& tau) noexcept {
  const double k_p = config.omega_n * config.omega_n;
  const double k_v = 2.0 * config.zeta * config.omega_n;
  const trajectory::Reference& reference = inputs.reference;

  model::ArmPoses goal;
  model::ComputePoses(inputs.arm, reference.q, goal);
  Mat6N J_goal;
  Mat6N J;
  model::ComputeBaseJacobian(inputs.arm, goal, J_goal);
  model::ComputeBaseJacobian(inputs.arm, inputs.poses, J);

  // The acceleration that corrects the end effector's error.
  Vec6 e_x;
  e_x << goal.X_BE.p - inputs.poses.X_BE.p,
      model::RotationVector(goal.X_BE.R.lazyProduct(inputs.poses.X_BE.R.transpose()));
  const Vec6 V_ref = J_goal.lazyProduct(reference.dq);
  const Vec6 V = J.lazyProduct(inputs.dq);
  Vec6 a = J_goal.lazyProduct(reference.ddq);
  a += model::BiasAcceleration(inputs.arm, goal, reference.dq);
  a -= model::BiasAcceleration(inputs.arm, inputs.poses, inputs.dq);
  a += k_v * (V_ref - V) + k_p * e_x;

  // M^-1 J^T, and Lambda's inverse, damped in proportion to its size.
  MatN M = inputs.dynamics.M;
  model::FactorCholesky(M);
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, model::kMaxJoints, 6> X = J.transpose();
  model::SolveCholesky(M, X);
  Mat6 A = J.lazyProduct(X);
  A.diagonal().array() += config.operational_damping * config.operational_damping * A.trace() / 6.0;
  model::FactorCholesky(A);

  // The posture's acceleration, without the part that would move the end effector.
  const VecN posture = reference.ddq + k_v * (reference.dq - inputs.dq) + k_p * (reference.q - inputs.q);
  Vec6 F = a - J.lazyProduct(posture);
  model::SolveCholesky(A, F);

  tau = inputs.dynamics.Cdq;
  tau += FrictionTorque(inputs.arm, config, reference, inputs.dq);
  tau += SpringTorque(inputs.arm, inputs.q);
  tau += inputs.dynamics.M.lazyProduct(posture);
  tau += J.transpose().lazyProduct(F);
}

}  // namespace fovea::motion_laws
