// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/weight_on_joints.hpp"

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <vector>

namespace fovea::sim {
namespace {

// A link and all links beyond it: their mass [kg], and mass times centre of mass in B [kg m].
struct Weight {
  double mass = 0.0;
  btVector3 moment = btVector3(0, 0, 0);
};

}  // namespace

Eigen::VectorXd WeightOnJoints(const btMultiBody& body, const SimRobot& robot, const btVector3& g) {
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(robot.num_dofs);
  if (g.isZero()) {
    return tau;
  }
  std::vector<Weight> hanging(robot.links.size());
  for (int i = static_cast<int>(robot.links.size()) - 2; i >= 0; --i) {  // from the tip to the base
    const btMultibodyLink& link = body.getLink(i);
    const btVector3& p_com = link.m_cachedWorldTransform.getOrigin();
    Weight& weight = hanging[static_cast<std::size_t>(i)];
    weight.mass += link.m_mass;
    weight.moment += link.m_mass * p_com;
    if (link.m_parent >= 0) {
      hanging[static_cast<std::size_t>(link.m_parent)].mass += weight.mass;
      hanging[static_cast<std::size_t>(link.m_parent)].moment += weight.moment;
    }
    if (link.m_dofCount == 0) {
      continue;
    }
    const btMatrix3x3& R_BP = link.m_cachedWorldTransform.getBasis();
    const int dof = robot.links[static_cast<std::size_t>(i + 1)].dof;
    if (link.m_jointType == btMultibodyLink::ePrismatic) {
      tau[dof] = -weight.mass * g.dot(R_BP * link.getAxisBottom(0));
    } else {
      const btVector3 p_joint = p_com - R_BP * link.m_dVector;
      const btVector3 lever = weight.moment - weight.mass * p_joint;
      tau[dof] = -g.dot((R_BP * link.getAxisTop(0)).cross(lever));
    }
  }
  return tau;
}

}  // namespace fovea::sim
