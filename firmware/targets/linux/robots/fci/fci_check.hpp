// SPDX-License-Identifier: Apache-2.0
// Checks of a Panda, without moving it.
#pragma once

#include <vector>

#include "firmware/targets/linux/check.hpp"

namespace fovea::hw {

// Compares limits and kinematics of the model with the robot's. Checks its mode, its states, its joint ranges
// and gravity.
void CheckFciRobot(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows);

}  // namespace fovea::hw
