// The arm as a Bullet multi-body: torques in, motion out. Knows the truth.
//
// Bullet's defaults that would falsify an arm are off: linear and angular damping, sleeping, the clamp at
// 100 rad/s. Double precision.
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

enum class Integrator {
  kSemiImplicitEuler,  // Bullet's default, one evaluation per step
  kRungeKutta4,        // four evaluations per step; keeps energy 7 orders better
};

struct BulletArmOptions {
  Integrator integrator = Integrator::kSemiImplicitEuler;
  bool table = true;  // a fixed plane at z = 0 of B, which the arm's collision shapes can touch
  bool gravity = true;
  bool may_be_loaded = false;  // SetLoad will be called; without it physics has one body less to step
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

  // From now on friction of `coulomb` [Nm, N] >= 0 in each joint: it takes away what speed it can, and holds
  // a joint at rest that no more than this pulls at.
  void SetStiction(const Eigen::VectorXd& coulomb);
  // That friction's torque on the joints in the last step [Nm, N].
  [[nodiscard]] Eigen::VectorXd StictionTorque() const;

  // From now on a point of `mass` [kg] >= 0 hangs at the robot's tip, with its velocity; the torque that
  // GravityTorque gives knows nothing of it. Needs BulletArmOptions::may_be_loaded.
  void SetLoad(double mass);

  // From now on the base leans by `tilt` [rad] about B's x, and the weight pulls aside; the torque that
  // GravityTorque gives knows nothing of it.
  void TiltBase(double tilt);

  // Moves on by `dt` [s] under the joint torques `tau` [Nm, N], gravity and contact.
  void Step(const Eigen::VectorXd& tau, double dt);

  // Joint accelerations at the present state under `tau`, gravity included, contact not; the state stays.
  [[nodiscard]] Eigen::VectorXd ForwardDynamics(const Eigen::VectorXd& tau);

  // Joint torques that hold the arm at rest where it is, from the links' weights on a base that is upright.
  [[nodiscard]] Eigen::VectorXd GravityTorque() const;

  // Pose of link `index` of the robot in B.
  [[nodiscard]] Eigen::Isometry3d LinkPose(int index) const;

  // Kinetic and potential energy [J].
  [[nodiscard]] double Energy() const;

  // Number of contact points with the table whose gap is below 0 after the last step, or after SetState and
  // FindContacts. The links meet nothing else: see LinkTouch.
  [[nodiscard]] int Contacts() const;
  void FindContacts();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fovea::sim
