// Checks of a robot that every driver makes alike.
#pragma once

#include "firmware/targets/linux/check.hpp"
#include "firmware/targets/linux/gravity_check.hpp"

namespace fovea::hw {

// What the robot's joints feel beside what the model says that they carry; `rests`: `mean` is there. Motion
// is refused where this fails.
CheckRow CheckGravity(const robots::Robot& robot, const RestMean& mean, bool rests, double allowed_nm);

// Whether each joint stands inside its range, less `margin` [rad].
CheckRow CheckRange(const robots::Robot& robot, const hal::ArmState& state, double margin);

}  // namespace fovea::hw
