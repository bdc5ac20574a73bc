// SPDX-License-Identifier: Apache-2.0
// Checks of a robot that all drivers share.
#pragma once

#include "firmware/targets/linux/check.hpp"
#include "firmware/targets/linux/gravity_check.hpp"

namespace fovea::hw {

// Compares the measured joint torques with the model's gravity. `rests`: `mean` is complete. If this check
// fails, motion is refused.
CheckRow CheckGravity(const robots::Robot& robot, const RestMean& mean, bool rests, double allowed_nm);

// Checks that each joint is inside its range, less `margin` [rad].
CheckRow CheckRange(const robots::Robot& robot, const hal::ArmState& state, double margin);

}  // namespace fovea::hw
