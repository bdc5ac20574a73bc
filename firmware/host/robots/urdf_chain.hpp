// The serial chain between two links of a URDF, as an ArmModel.
#pragma once

#include "firmware/host/robots/robot.hpp"

namespace fovea::robots {

// Fills joint_names and the geometry, inertia, position, velocity and effort limits of `robot.model` from
// `robot.urdf`; an empty base_link or tip_link is found and filled in. InputError as LoadRobot says.
void ReadUrdfChain(Robot& robot);

}  // namespace fovea::robots
