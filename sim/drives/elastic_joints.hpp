// SPDX-License-Identifier: Apache-2.0
// Joints whose gears give: a spring and a damper between the motor of each joint and its link.
//
//   B ddtheta = tau_motor - tau      M ddq = tau + tau_links - h      tau = K (theta - q) + D (dtheta - dq)
//
// (Spong, Modeling and control of elastic joint robots, 1987: the rotors' turn with the links is left out.)
// Over a tick the links' M and h are constant. Then the deflections d = theta - q obey
//   ddd = ddq_motors - ddq_links - (B^-1 + M^-1) (K d + D dd)
// for all joints together. This is solved in steps of equal length by the implicit midpoint rule. It is
// stable for any stiffness, loses no energy without damping, and goes to the rigid arm as K grows. The steps
// are short enough for the fastest swing: it turns by at most kMostTurn in one, up to kMostSteps of them.
#pragma once

#include <Eigen/Core>

namespace fovea::sim {

// The gear of a joint, which gives.
struct JointSpring {
  double stiffness = 0.0;  // > 0 [Nm/rad, N/m]
  double damping = 0.0;    // [Nm s/rad, N s/m]
};

// One entry for each moving joint.
struct ElasticJointsConfig {
  Eigen::VectorXd stiffness;  // > 0 [Nm/rad, N/m]
  Eigen::VectorXd damping;    // >= 0 [Nm s/rad, N s/m]
  Eigen::VectorXd inertia;    // of the rotors, seen at the joint, > 0 [kg m^2, kg]
  Eigen::VectorXd holding;    // Coulomb friction that holds a motor at rest, >= 0 [Nm, N]
};

class ElasticJoints {
 public:
  static constexpr double kMostTurn = 0.2;  // [rad]
  static constexpr int kMostSteps = 100;

  // std::invalid_argument: a value is outside its range.
  explicit ElasticJoints(const ElasticJointsConfig& config);

  // The springs carry `tau` [Nm, N] at rest, on links that move with `dq` [rad/s, m/s].
  void Settle(const Eigen::VectorXd& tau, const Eigen::VectorXd& dq);
  // The motors have the speed `dtheta` from now on; the deflections stay.
  void SetMotorSpeed(const Eigen::VectorXd& dtheta) { dtheta_ = dtheta; }

  // Advances by `dt` [s] under the motors' torques `tau_motor` [Nm, N]. Of the links, at the beginning:
  // velocities `dq`, accelerations `ddq_links` without the springs, inverse mass matrix `A`. The caller moves
  // the links under torque().
  void Step(const Eigen::VectorXd& tau_motor, const Eigen::VectorXd& dq, const Eigen::VectorXd& ddq_links,
            const Eigen::MatrixXd& A, double dt);

  // Mean torque of springs and dampers on the links in the last step [Nm, N].
  [[nodiscard]] const Eigen::VectorXd& torque() const { return torque_; }
  // theta - q [rad, m].
  [[nodiscard]] const Eigen::VectorXd& deflection() const { return deflection_; }
  [[nodiscard]] const Eigen::VectorXd& motor_speed() const { return dtheta_; }

  // Kinetic energy of the rotors and energy of the springs [J].
  [[nodiscard]] double Energy() const;

 private:
  ElasticJointsConfig config_;
  Eigen::VectorXd deflection_;
  Eigen::VectorXd dtheta_;
  Eigen::VectorXd torque_;
};

}  // namespace fovea::sim
