// SPDX-License-Identifier: Apache-2.0
#include "sim/drives/elastic_joints.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/physics/friction_impulse.hpp"

namespace fovea::sim {

ElasticJoints::ElasticJoints(const ElasticJointsConfig& config)
    : config_(config),
      deflection_(Eigen::VectorXd::Zero(config.stiffness.size())),
      dtheta_(deflection_),
      torque_(deflection_) {
  if (!(config.stiffness.array() > 0.0).all() || !(config.inertia.array() > 0.0).all() ||
      !(config.damping.array() >= 0.0).all() || !(config.holding.array() >= 0.0).all()) {
    throw std::invalid_argument("ElasticJoints: stiffness or inertia is not above 0, or damping is below 0");
  }
}

void ElasticJoints::Settle(const Eigen::VectorXd& tau, const Eigen::VectorXd& dq) {
  deflection_ = tau.cwiseQuotient(config_.stiffness);
  dtheta_ = dq;
  torque_ = tau;
}

void ElasticJoints::Step(const Eigen::VectorXd& tau_motor, const Eigen::VectorXd& dq,
                         const Eigen::VectorXd& ddq_links, const Eigen::MatrixXd& A, double dt) {
  const Eigen::VectorXd& K = config_.stiffness;
  const Eigen::VectorXd& D = config_.damping;
  const Eigen::VectorXd& B = config_.inertia;
  Eigen::MatrixXd S = A;  // acceleration of the deflections per torque
  S.diagonal() += B.cwiseInverse();
  // The sum of the squared frequencies is at least the largest of them.
  const double fastest = std::sqrt(S.diagonal().dot(K));
  const int steps = std::clamp(static_cast<int>(std::ceil(fastest * dt / kMostTurn)), 1, kMostSteps);
  const double h = dt / steps;

  // With v the mean rate of a step: (2 + h S (h K / 2 + D)) v = 2 dd + h (ddd_0 - S K d).
  const Eigen::VectorXd mid = 0.5 * h * K + D;  // torque at the middle of a step, per rate
  Eigen::MatrixXd implicit = h * S * mid.asDiagonal();
  implicit.diagonal().array() += 2.0;
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(implicit);
  const Eigen::VectorXd ddd_0 = tau_motor.cwiseQuotient(B) - ddq_links;
  // Friction that holds is an impulse on the motors, which changes v and their speeds at the step's end.
  const bool holds = !config_.holding.isZero(0.0);
  Eigen::MatrixXd rate_per_impulse;
  Eigen::MatrixXd motors_per_impulse;
  if (holds) {
    rate_per_impulse = lu.solve(Eigen::MatrixXd(B.cwiseInverse().asDiagonal()));
    motors_per_impulse = 2.0 * rate_per_impulse + h * A * mid.asDiagonal() * rate_per_impulse;
  }
  Eigen::VectorXd speed = dq;  // of the links
  Eigen::VectorXd rate = dtheta_ - dq;
  torque_.setZero();
  for (int i = 0; i < steps; ++i) {
    Eigen::VectorXd v = lu.solve(2.0 * rate + h * (ddd_0 - S * K.cwiseProduct(deflection_)));
    if (holds) {
      const Eigen::VectorXd tau_free = K.cwiseProduct(deflection_) + mid.cwiseProduct(v);
      const Eigen::VectorXd motors = speed + h * (ddq_links + A * tau_free) + 2.0 * v - rate;  // at the end
      v += rate_per_impulse * FrictionImpulse(motors_per_impulse, motors, h * config_.holding);
    }
    const Eigen::VectorXd tau = K.cwiseProduct(deflection_) + mid.cwiseProduct(v);
    deflection_ += h * v;
    rate = 2.0 * v - rate;
    speed += h * (ddq_links + A * tau);
    torque_ += tau / steps;
  }
  dtheta_ = speed + rate;
}

double ElasticJoints::Energy() const {
  return 0.5 * config_.inertia.dot(dtheta_.cwiseAbs2()) +
         0.5 * config_.stiffness.dot(deflection_.cwiseAbs2());
}

}  // namespace fovea::sim
