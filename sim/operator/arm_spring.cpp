// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/arm_spring.hpp"

namespace fovea::sim {
namespace {

// The Jacobian of the point `p_B`, fixed to `link` [3 x num_dofs], in axes of B.
Eigen::Matrix3Xd PointJacobian(const SimRobot& robot, const std::vector<Eigen::Isometry3d>& X_BL, int link,
                               const Eigen::Vector3d& p_B) {
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, robot.num_dofs);
  for (int i = link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    const SimLink& moved = robot.links[static_cast<std::size_t>(i)];
    if (moved.dof < 0) {
      continue;
    }
    const Eigen::Isometry3d& X_BLi = X_BL[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis_B = X_BLi.linear() * moved.axis_L;
    J.col(moved.dof) = moved.joint == SimJointKind::kPrismatic
                           ? axis_B
                           : Eigen::Vector3d(axis_B.cross(p_B - X_BLi.translation()));
  }
  return J;
}

}  // namespace

Eigen::Vector3d SpringForce(const ArmSpring& spring, const Eigen::Vector3d& p_BP,
                            const Eigen::Vector3d& v_BP) {
  const Eigen::Vector3d force = ArmSpring::kStiffness * (spring.p_BT - p_BP) - ArmSpring::kDamping * v_BP;
  const double size = force.norm();
  return size > ArmSpring::kMostForce ? Eigen::Vector3d(force * (ArmSpring::kMostForce / size)) : force;
}

Eigen::VectorXd SpringTorque(const ArmSpring& spring, const SimRobot& robot,
                             const std::vector<Eigen::Isometry3d>& X_BL, const Eigen::VectorXd& dq) {
  const Eigen::Vector3d p_BP = X_BL[static_cast<std::size_t>(spring.link)] * spring.p_LP;
  const Eigen::Matrix3Xd J = PointJacobian(robot, X_BL, spring.link, p_BP);
  return J.transpose() * SpringForce(spring, p_BP, J * dq);
}

}  // namespace fovea::sim
