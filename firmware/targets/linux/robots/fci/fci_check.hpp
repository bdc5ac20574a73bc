// What of a Panda is as it should be; it is not moved.
#pragma once

#include <vector>

#include "firmware/targets/linux/check.hpp"

namespace fovea::hw {

// Limits and kinematics of the model beside the robot's, its mode, its states, where it stands, what its
// joints carry.
void CheckFciRobot(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows);

}  // namespace fovea::hw
