// SPDX-License-Identifier: Apache-2.0
// The links of a robot as those of a Bullet multi-body.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Geometry>
#include <vector>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// A body's frame P in Bullet's convention: at the centre of mass, along the principal axes of inertia. L is
// the link's frame.
struct PrincipalBody {
  Eigen::Isometry3d X_LP = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_PL = Eigen::Isometry3d::Identity();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();  // [kg m^2]
};

// One per link of the robot.
std::vector<PrincipalBody> PrincipalBodies(const SimRobot& robot);

// Sets up link `i` of Bullet, which is link i + 1 of the robot; Bullet's base is the robot's link 0.
void SetUpLink(const SimRobot& robot, const std::vector<PrincipalBody>& bodies, int i, btMultiBody& body);

// Sets up link `i` of Bullet as a load: fixed in the tip's frame, without a mass.
void SetUpLoad(const SimRobot& robot, const std::vector<PrincipalBody>& bodies, int i, btMultiBody& body);

}  // namespace fovea::sim
