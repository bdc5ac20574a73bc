// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/multi_body_joints.hpp"

namespace fovea::sim {
namespace {

constexpr int kBaseDofs = 6;  // Bullet's vectors begin with those of the base, also if it is fixed

}  // namespace

Eigen::VectorXd MultiBodyJoints::q() const {
  Eigen::VectorXd q(size());
  for (int i = 0; i < size(); ++i) {
    q[i] = body_.getJointPos(link(i));
  }
  return q;
}

Eigen::VectorXd MultiBodyJoints::dq() const {
  Eigen::VectorXd dq(size());
  for (int i = 0; i < size(); ++i) {
    dq[i] = body_.getJointVel(link(i));
  }
  return dq;
}

void MultiBodyJoints::SetState(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) {
  for (int i = 0; i < size(); ++i) {
    body_.setJointPos(link(i), q[i]);
    body_.setJointVel(link(i), dq[i]);
  }
  PlaceLinks();
  body_.updateCollisionObjectWorldTransforms(rotations_, vectors_);
}

void MultiBodyJoints::AddTorque(const Eigen::VectorXd& tau) {
  for (int i = 0; i < size(); ++i) {
    body_.addJointTorque(link(i), tau[i]);
  }
}

Eigen::VectorXd MultiBodyJoints::Acceleration(const Eigen::VectorXd& tau, const btVector3& g) {
  const Eigen::VectorXd q_before = q();
  const Eigen::VectorXd dq_before = dq();
  body_.clearForcesAndTorques();
  AddTorque(tau);
  for (int i = 0; i < body_.getNumLinks(); ++i) {
    body_.addLinkForce(i, g * body_.getLinkMass(i));
  }
  // Bullet's function integrates the velocities over dt. With dt = 1 their change is the acceleration.
  body_.computeAccelerationsArticulatedBodyAlgorithmMultiDof(1.0, scalars_, vectors_, matrices_, false, false,
                                                             false);
  const Eigen::VectorXd ddq = dq() - dq_before;
  body_.clearForcesAndTorques();
  SetState(q_before, dq_before);
  return ddq;
}

Eigen::MatrixXd MultiBodyJoints::InverseMass() {
  Eigen::MatrixXd inverse(size(), size());
  Eigen::VectorXd force = Eigen::VectorXd::Zero(kBaseDofs + size());
  Eigen::VectorXd change(kBaseDofs + size());
  const auto at = [this](int joint) { return kBaseDofs + body_.getLink(link(joint)).m_dofOffset; };
  for (int i = 0; i < size(); ++i) {
    force[at(i)] = 1.0;
    body_.calcAccelerationDeltasMultiDof(force.data(), change.data(), scalars_, vectors_);
    force[at(i)] = 0.0;
    for (int k = 0; k < size(); ++k) {
      inverse(k, i) = change[at(k)];
    }
  }
  return inverse;
}

}  // namespace fovea::sim
