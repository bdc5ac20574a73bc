// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/chain.hpp"

namespace fovea::sim {

Chain::Chain(const SimRobot& robot) : robot_(robot) {
  for (SimLink& link : robot_.links) {  // shapes are not needed here
    link.visuals.clear();
    link.collisions.clear();
  }
}

std::vector<Chain::Moved> Chain::Poses(const Eigen::VectorXd& q) const {
  std::vector<Moved> moved(robot_.links.size());
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const SimLink& link = robot_.links[k];
    Eigen::Isometry3d X = link.parent < 0 ? Eigen::Isometry3d::Identity()
                                          : moved[static_cast<std::size_t>(link.parent)].X_BL * link.X_PL;
    moved[k].axis = X.linear() * link.axis_L;
    if (link.joint == SimJointKind::kRevolute) {
      X.rotate(Eigen::AngleAxisd(q[link.dof], link.axis_L));
    } else if (link.joint == SimJointKind::kPrismatic) {
      X.translate(q[link.dof] * link.axis_L);
    }
    moved[k].X_BL = X;
  }
  return moved;
}

// The Jacobian [v; w] of the point `p_B` of `link`, by the joints between base and link.
Jacobian Chain::PointJacobian(const std::vector<Moved>& links, int link, const Eigen::Vector3d& p_B) const {
  Jacobian J = Jacobian::Zero(6, robot_.num_dofs);
  for (int k = link; k >= 0; k = robot_.links[static_cast<std::size_t>(k)].parent) {
    const SimLink& at = robot_.links[static_cast<std::size_t>(k)];
    const Moved& moved = links[static_cast<std::size_t>(k)];
    if (at.joint == SimJointKind::kRevolute) {
      J.col(at.dof) << moved.axis.cross(p_B - moved.X_BL.translation()), moved.axis;
    } else if (at.joint == SimJointKind::kPrismatic) {
      J.col(at.dof) << moved.axis, Eigen::Vector3d::Zero();
    }
  }
  return J;
}

Eigen::Isometry3d Chain::TipPose(const Eigen::VectorXd& q) const {
  return Poses(q)[static_cast<std::size_t>(robot_.tip)].X_BL;
}

Eigen::Isometry3d Chain::TipPose(const Eigen::VectorXd& q, Jacobian& J) const {
  const std::vector<Moved> links = Poses(q);
  const Eigen::Isometry3d X_BE = links[static_cast<std::size_t>(robot_.tip)].X_BL;
  J = PointJacobian(links, robot_.tip, X_BE.translation());
  return X_BE;
}

std::vector<Eigen::Isometry3d> Chain::LinkPoses(const Eigen::VectorXd& q) const {
  std::vector<Eigen::Isometry3d> X_BL;
  X_BL.reserve(robot_.links.size());
  for (const Moved& moved : Poses(q)) {
    X_BL.push_back(moved.X_BL);
  }
  return X_BL;
}

Eigen::MatrixXd Chain::MassMatrix(const Eigen::VectorXd& q) const {
  const std::vector<Moved> links = Poses(q);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(robot_.num_dofs, robot_.num_dofs);
  for (std::size_t k = 1; k < links.size(); ++k) {
    const SimLink& link = robot_.links[k];
    if (link.dof >= 0) {
      M(link.dof, link.dof) += link.rotor_inertia;
    }
    if (link.mass == 0.0) {
      continue;
    }
    const Eigen::Isometry3d X_BCom = links[k].X_BL * link.X_LCom;
    const Jacobian J = PointJacobian(links, static_cast<int>(k), X_BCom.translation());
    const Eigen::Matrix3d I_B = X_BCom.linear() * link.I_Com * X_BCom.linear().transpose();
    M += link.mass * J.topRows<3>().transpose() * J.topRows<3>() +
         J.bottomRows<3>().transpose() * I_B * J.bottomRows<3>();
  }
  return M;
}

Eigen::VectorXd Chain::CoriolisTorque(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const {
  struct Motion {
    Eigen::Vector3d w = Eigen::Vector3d::Zero();   // angular velocity
    Eigen::Vector3d dw = Eigen::Vector3d::Zero();  // its derivative at ddq = 0
    Eigen::Vector3d a = Eigen::Vector3d::Zero();   // acceleration of the link's origin
  };
  const std::vector<Moved> links = Poses(q);
  std::vector<Motion> motion(links.size());
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(robot_.num_dofs);
  for (std::size_t k = 1; k < links.size(); ++k) {
    const SimLink& link = robot_.links[k];
    const auto parent = static_cast<std::size_t>(link.parent);
    const Motion& base = motion[parent];
    Motion& own = motion[k];
    const Eigen::Vector3d r = links[k].X_BL.translation() - links[parent].X_BL.translation();
    own = {base.w, base.dw, base.a + base.dw.cross(r) + base.w.cross(base.w.cross(r))};
    if (link.joint == SimJointKind::kRevolute) {
      const Eigen::Vector3d turn = links[k].axis * dq[link.dof];
      own.w += turn;
      own.dw += base.w.cross(turn);
    } else if (link.joint == SimJointKind::kPrismatic) {
      own.a += 2.0 * base.w.cross(links[k].axis * dq[link.dof]);
    }
    if (link.mass == 0.0) {
      continue;
    }
    // The link's inertial force and moment at its centre of mass load all joints towards the base.
    const Eigen::Isometry3d X_BCom = links[k].X_BL * link.X_LCom;
    const Eigen::Vector3d c = X_BCom.translation() - links[k].X_BL.translation();
    const Eigen::Matrix3d I_B = X_BCom.linear() * link.I_Com * X_BCom.linear().transpose();
    Eigen::Matrix<double, 6, 1> wrench;
    wrench << link.mass * (own.a + own.dw.cross(c) + own.w.cross(own.w.cross(c))),
        I_B * own.dw + own.w.cross(I_B * own.w);
    tau += PointJacobian(links, static_cast<int>(k), X_BCom.translation()).transpose() * wrench;
  }
  return tau;
}

}  // namespace fovea::sim
