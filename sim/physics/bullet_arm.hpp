// SPDX-License-Identifier: Apache-2.0
// The arm as a Bullet multi-body: torques in, true motion out.
//
// Bullet's defaults that would distort an arm's motion are off: linear and angular damping, sleeping, the
// speed limit of 100 rad/s. Double precision.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "sim/physics/integrator.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

struct BulletArmOptions {
  Integrator integrator = Integrator::kSemiImplicitEuler;
  bool table = true;  // a fixed plane at z = 0 of B, which the arm's collision shapes can touch
  std::vector<Eigen::AlignedBox3d> boxes{};  // fixed in B, which they can touch, too
  bool gravity = true;
  bool may_be_loaded = false;  // SetLoad may be called; adds a body to the physics
};

class BulletArm {
 public:
  BulletArm(const SimRobot& robot, const BulletArmOptions& options);
  ~BulletArm();
  BulletArm(const BulletArm&) = delete;
  BulletArm& operator=(const BulletArm&) = delete;

  [[nodiscard]] int num_dofs() const;

  // Joint positions [rad, m] and velocities, one per moving joint, base to tip.
  void SetState(const Eigen::VectorXd& q, const Eigen::VectorXd& dq);
  [[nodiscard]] const Eigen::VectorXd& q() const;
  [[nodiscard]] const Eigen::VectorXd& dq() const;

  // Adds Coulomb friction of `coulomb` [Nm, N] >= 0 to each joint: it slows a moving joint, and holds a joint
  // at rest against any smaller torque.
  void SetStiction(const Eigen::VectorXd& coulomb);
  // Torque of that friction in the last step [Nm, N].
  [[nodiscard]] Eigen::VectorXd StictionTorque() const;

  // Attaches a point of `mass` [kg] >= 0 to the robot's tip, with the tip's velocity. GravityTorque ignores
  // it. Needs BulletArmOptions::may_be_loaded.
  void SetLoad(double mass);

  // Tilts the base about its x axis, and then about its y axis [rad], which rotates gravity. GravityTorque
  // ignores the tilt.
  void TiltBase(double about_x, double about_y);

  // Advances by `dt` [s] under the joint torques `tau` [Nm, N], gravity and contact.
  void Step(const Eigen::VectorXd& tau, double dt);

  // Joint accelerations at the present state under `tau` and gravity, without contact. Keeps the state.
  [[nodiscard]] Eigen::VectorXd ForwardDynamics(const Eigen::VectorXd& tau);

  // The inverse of the links' mass matrix [num_dofs x num_dofs], in the state of the last ForwardDynamics.
  [[nodiscard]] Eigen::MatrixXd InverseMass();

  // Joint torques that compensate the links' weights at the present position, for an upright base.
  [[nodiscard]] Eigen::VectorXd GravityTorque() const;

  // Pose of link `index` of the robot in B.
  [[nodiscard]] Eigen::Isometry3d LinkPose(int index) const;

  // Kinetic and potential energy [J].
  [[nodiscard]] double Energy() const;

  // Number of contact points with table and boxes (negative gap, or a contact impulse) after the last step,
  // or after SetState and FindContacts. The physics has no other contacts; see LinkTouch.
  [[nodiscard]] int Contacts() const;
  void FindContacts();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
