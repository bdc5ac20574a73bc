// SPDX-License-Identifier: Apache-2.0
// How far a joint moves the arm at most: the levers that turn joint motions into a bound of any point's way.
#pragma once

#include <array>

#include "firmware/core/config/guard_config.hpp"
#include "firmware/core/model/arm_model.hpp"

namespace fovea::barriers {

using PerJoint = std::array<double, model::kMaxJoints>;

// The largest travel of any point of arm and hand per travel of each joint: the point's distance from the
// joint's axis, bounded by the lengths of the links between them; 1 for a prismatic joint. Real-time: yes.
[[nodiscard]] PerJoint Levers(const model::ArmModel& arm, const config::HandShape& hand) noexcept;

}  // namespace fovea::barriers
