// SPDX-License-Identifier: Apache-2.0
// Gravity torques of an arm, from Bullet's link poses.
#pragma once

#include <Eigen/Core>

#include "sim/robot/sim_robot.hpp"

class btMultiBody;
class btVector3;

namespace fovea::sim {

// Joint torques that compensate gravity at the pose of `body`: [num_dofs] Nm, or N for a prismatic joint.
// Link i of `body` is link i + 1 of `robot`. Ignores further links of `body` (a load). `g` in B [m/s^2].
Eigen::VectorXd WeightOnJoints(const btMultiBody& body, const SimRobot& robot, const btVector3& g);

}  // namespace fovea::sim
