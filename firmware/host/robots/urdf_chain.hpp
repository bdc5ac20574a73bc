// SPDX-License-Identifier: Apache-2.0
// The serial chain between two links of a URDF, as an ArmModel.
#pragma once

#include "firmware/host/robots/robot.hpp"

namespace fovea::robots {

// Fills joint_names and the geometry, inertia, position, velocity and effort limits of `robot.model` from
// `robot.urdf`. Finds and fills in an empty base_link or tip_link. InputError as for LoadRobot.
void ReadUrdfChain(Robot& robot);

}  // namespace fovea::robots
