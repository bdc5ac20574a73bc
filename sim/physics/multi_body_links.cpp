// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/multi_body_links.hpp"

#include <Eigen/Eigenvalues>

#include "sim/physics/bullet_types.hpp"

namespace fovea::sim {
namespace {

PrincipalBody Diagonalise(const SimLink& link) {
  PrincipalBody body;
  if (link.mass == 0.0) {
    return body;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(link.I_Com);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) {
    axes.col(0) = -axes.col(0);
  }
  body.moments = solver.eigenvalues();
  body.X_LP = link.X_LCom;
  body.X_LP.linear() = link.X_LCom.linear() * axes;
  body.X_PL = body.X_LP.inverse();
  return body;
}

}  // namespace

std::vector<PrincipalBody> PrincipalBodies(const SimRobot& robot) {
  std::vector<PrincipalBody> bodies;
  for (const SimLink& link : robot.links) {
    bodies.push_back(Diagonalise(link));
  }
  return bodies;
}

void SetUpLink(const SimRobot& robot, const std::vector<PrincipalBody>& bodies, int i, btMultiBody& body) {
  const auto k = static_cast<std::size_t>(i + 1);
  const SimLink& link = robot.links[k];
  const PrincipalBody& own = bodies[k];
  const PrincipalBody& parent = bodies[static_cast<std::size_t>(link.parent)];
  const Eigen::Isometry3d X_PaL = parent.X_PL * link.X_PL;  // link frame in the parent's body frame
  const Eigen::Isometry3d X_PaPo = X_PaL * own.X_LP;
  const btQuaternion parent_to_this = ToBullet(Eigen::Matrix3d(X_PaPo.linear().transpose()));
  const btVector3 com_to_pivot = ToBullet(Eigen::Vector3d(X_PaL.translation()));
  const Eigen::Matrix3d R_PoL = own.X_LP.linear().transpose();
  const btVector3 pivot_to_com = ToBullet(Eigen::Vector3d(R_PoL * own.X_LP.translation()));
  const btVector3 axis = ToBullet(Eigen::Vector3d(R_PoL * link.axis_L));
  const btVector3 inertia = ToBullet(own.moments);
  switch (link.joint) {
    case SimJointKind::kFixed:
      body.setupFixed(i, link.mass, inertia, link.parent - 1, parent_to_this, com_to_pivot, pivot_to_com);
      break;
    case SimJointKind::kRevolute:
      body.setupRevolute(i, link.mass, inertia, link.parent - 1, parent_to_this, axis, com_to_pivot,
                         pivot_to_com, true);
      break;
    case SimJointKind::kPrismatic:
      body.setupPrismatic(i, link.mass, inertia, link.parent - 1, parent_to_this, axis, com_to_pivot,
                          pivot_to_com, true);
      break;
  }
}

void SetUpLoad(const SimRobot& robot, const std::vector<PrincipalBody>& bodies, int i, btMultiBody& body) {
  const Eigen::Isometry3d X_PaL = bodies[static_cast<std::size_t>(robot.tip)].X_PL;
  body.setupFixed(i, 0.0, btVector3(0, 0, 0), robot.tip - 1,
                  ToBullet(Eigen::Matrix3d(X_PaL.linear().transpose())),
                  ToBullet(Eigen::Vector3d(X_PaL.translation())), btVector3(0, 0, 0));
}

}  // namespace fovea::sim
