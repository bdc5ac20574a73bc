// SPDX-License-Identifier: Apache-2.0
// A spring between a point of a link and a point of space, by which the operator pulls the arm.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

struct ArmSpring {
  static constexpr double kStiffness = 200.0;  // [N/m]
  static constexpr double kDamping = 20.0;     // of the point's motion [N s/m]
  static constexpr double kMostForce = 50.0;   // [N]; below what a person's hand exerts

  int link = 0;                                    // index in SimRobot::links
  Eigen::Vector3d p_LP = Eigen::Vector3d::Zero();  // the point P, fixed to the link [m]
  Eigen::Vector3d p_BT = Eigen::Vector3d::Zero();  // where it is pulled to [m]
};

// The force on P [N, in axes of B]. `v_BP`: its velocity [m/s].
Eigen::Vector3d SpringForce(const ArmSpring& spring, const Eigen::Vector3d& p_BP,
                            const Eigen::Vector3d& v_BP);

// The joint torques [num_dofs; Nm, N] of the spring at link poses `X_BL` and joint velocities `dq`: J^T F,
// with the Jacobian J of P.
Eigen::VectorXd SpringTorque(const ArmSpring& spring, const SimRobot& robot,
                             const std::vector<Eigen::Isometry3d>& X_BL, const Eigen::VectorXd& dq);

}  // namespace fovea::sim
