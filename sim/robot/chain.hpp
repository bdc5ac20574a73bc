// SPDX-License-Identifier: Apache-2.0
// Kinematics and dynamics of a simulated arm at any joint position, for the robot's own controller.
//
// Uses only the URDF, like the physics, and shares no code with the servo's model; tests compare the two.
// Link Jacobians for M, recursive Newton-Euler for C dq (Siciliano et al., Robotics, 2009, ch. 7).
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

class Chain {
 public:
  explicit Chain(const SimRobot& robot);

  [[nodiscard]] int num_dofs() const { return robot_.num_dofs; }

  // Pose of the tip E in B at `q`. `J` becomes its Jacobian: [v; w] of E's origin, in axes of B.
  [[nodiscard]] Eigen::Isometry3d TipPose(const Eigen::VectorXd& q) const;
  [[nodiscard]] Eigen::Isometry3d TipPose(const Eigen::VectorXd& q, Jacobian& J) const;

  // Pose of each link in B.
  [[nodiscard]] std::vector<Eigen::Isometry3d> LinkPoses(const Eigen::VectorXd& q) const;

  // The joint-space mass matrix, with the rotors' inertias on its diagonal.
  [[nodiscard]] Eigen::MatrixXd MassMatrix(const Eigen::VectorXd& q) const;
  // Centrifugal and Coriolis torques C(q, dq) dq.
  [[nodiscard]] Eigen::VectorXd CoriolisTorque(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const;

 private:
  struct Moved {
    Eigen::Isometry3d X_BL;
    Eigen::Vector3d axis;  // joint axis, in B
  };
  [[nodiscard]] std::vector<Moved> Poses(const Eigen::VectorXd& q) const;
  [[nodiscard]] Jacobian PointJacobian(const std::vector<Moved>& links, int link,
                                       const Eigen::Vector3d& p_B) const;

  SimRobot robot_;
};

}  // namespace fovea::sim
