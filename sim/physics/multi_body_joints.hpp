// SPDX-License-Identifier: Apache-2.0
// The moving joints of a Bullet multi-body, as vectors with one entry per joint, base to tip.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Core>
#include <vector>

namespace fovea::sim {

class MultiBodyJoints {
 public:
  // `links`: Bullet's link of each moving joint. `body` must outlive it.
  MultiBodyJoints(btMultiBody& body, std::vector<int> links) : body_(body), links_(std::move(links)) {}

  [[nodiscard]] int size() const { return static_cast<int>(links_.size()); }
  [[nodiscard]] int link(int joint) const { return links_[static_cast<std::size_t>(joint)]; }

  // Positions [rad, m] and velocities.
  [[nodiscard]] Eigen::VectorXd q() const;
  [[nodiscard]] Eigen::VectorXd dq() const;
  // Also moves the links and their colliders.
  void SetState(const Eigen::VectorXd& q, const Eigen::VectorXd& dq);
  // Moves the links to the joints' positions; the colliders stay.
  void PlaceLinks() { body_.forwardKinematics(rotations_, vectors_); }

  // Adds `tau` [Nm, N] to the torques of the next step.
  void AddTorque(const Eigen::VectorXd& tau);

  // Accelerations under `tau` [Nm, N] and gravity `g` in B [m/s^2], without contact, of the links alone:
  // without rotors. Keeps the state.
  [[nodiscard]] Eigen::VectorXd Acceleration(const Eigen::VectorXd& tau, const btVector3& g);
  // The inverse of the links' mass matrix, in the state of the last Acceleration.
  [[nodiscard]] Eigen::MatrixXd InverseMass();

 private:
  btMultiBody& body_;
  std::vector<int> links_;
  btAlignedObjectArray<btScalar> scalars_;  // scratch
  btAlignedObjectArray<btVector3> vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
  btAlignedObjectArray<btQuaternion> rotations_;
};

}  // namespace fovea::sim
