// How an arm's weight pulls at its joints, in Bullet's own poses.
#pragma once

#include <Eigen/Core>

#include "sim/robot/sim_robot.hpp"

class btMultiBody;
class btVector3;

namespace fovea::sim {

// What the joints must give so that `robot`, of which link i + 1 is link i of `body`, hangs still where
// `body` is: [num_dofs] Nm, N for a joint that slides. `g` [m/s^2], frame B. What `body` has beyond the
// robot's links, a load, does not count.
Eigen::VectorXd WeightOnJoints(const btMultiBody& body, const SimRobot& robot, const btVector3& g);

}  // namespace fovea::sim
