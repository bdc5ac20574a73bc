// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/rotors.hpp"

#include <utility>

#include "sim/physics/friction_impulse.hpp"

namespace fovea::sim {

Rotors::Rotors(Eigen::VectorXd inertia, Integrator integrator, MultiBodyJoints& joints)
    : inertia_(std::move(inertia)), integrator_(integrator), joints_(joints) {}

// With A = M^-1 and ddq_0 = A (tau - h), which Bullet computes: (1 + A I_r) ddq = ddq_0.
Eigen::VectorXd Rotors::Acceleration(const Eigen::VectorXd& tau, const btVector3& g) {
  const Eigen::VectorXd ddq_0 = joints_.Acceleration(tau, g);
  return WithRotors(joints_.InverseMass()).solve(ddq_0);
}

Eigen::PartialPivLU<Eigen::MatrixXd> Rotors::WithRotors(const Eigen::MatrixXd& A) const {
  Eigen::MatrixXd S = A * inertia_.asDiagonal();
  S.diagonal().array() += 1.0;
  return S.partialPivLu();
}

RotorStep Rotors::Plan(const Eigen::VectorXd& tau, const btVector3& g, double dt) {
  const Eigen::VectorXd q = joints_.q();
  const Eigen::VectorXd dq = joints_.dq();
  const Eigen::VectorXd ddq_0 = joints_.Acceleration(tau, g);
  const Eigen::MatrixXd A = joints_.InverseMass();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu = WithRotors(A);

  Eigen::VectorXd ddq = lu.solve(ddq_0);  // mean over the step
  RotorStep step;
  step.shift = Eigen::VectorXd::Zero(dq.size());
  if (integrator_ == Integrator::kRungeKutta4) {
    const auto at = [&](const Eigen::VectorXd& q_at, const Eigen::VectorXd& dq_at) {
      joints_.SetState(q_at, dq_at);
      return Acceleration(tau, g);
    };
    const Eigen::VectorXd v2 = dq + 0.5 * dt * ddq;
    const Eigen::VectorXd a2 = at(q + 0.5 * dt * dq, v2);
    const Eigen::VectorXd v3 = dq + 0.5 * dt * a2;
    const Eigen::VectorXd a3 = at(q + 0.5 * dt * v2, v3);
    const Eigen::VectorXd v4 = dq + dt * a3;
    const Eigen::VectorXd a4 = at(q + dt * v3, v4);
    joints_.SetState(q, dq);
    ddq = (ddq + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
    const Eigen::VectorXd dq_mean = (dq + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
    step.shift = dt * (dq_mean - (dq + dt * ddq));
  }
  step.stiction = Eigen::VectorXd::Zero(dq.size());
  if (coulomb_.size() > 0) {
    const Eigen::MatrixXd W = lu.solve(A);  // (M + I_r)^-1
    step.stiction = FrictionImpulse(W, dq + dt * ddq, dt * coulomb_) / dt;
    const Eigen::VectorXd ddq_held = W * step.stiction;
    ddq += ddq_held;
    if (integrator_ == Integrator::kRungeKutta4) {
      step.shift -= 0.5 * dt * dt * ddq_held;  // the friction acts all over the step
    }
  }
  step.tau = tau + A.partialPivLu().solve(ddq - ddq_0);
  return step;
}

double Rotors::Energy() const { return 0.5 * joints_.dq().cwiseAbs2().dot(inertia_); }

}  // namespace fovea::sim
