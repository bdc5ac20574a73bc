// SPDX-License-Identifier: Apache-2.0
// The path of a reference that comes to rest with every joint at full braking.
//
// Each joint's velocity goes to zero in the shortest time that its acceleration and jerk limits allow
// (velocity_change.hpp). The joints stop at different times, so that the end effector's path is not planned.
// It is checked point by point.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/core/model/lazy_poses.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

// The limits that a stop from `reference` would exceed: the joints' ranges, the workspace, obstacles of hand
// and links, the arm itself, each with its margin; and the hand's linear and angular speed, which can rise
// while the joints stop one after the other. 0 if it exceeds none. Past a limit the arm may only come back.
// `now`: the arm at the previous reference. `known`: from earlier proofs with the same `config`; adds what
// this one finds, and changes no verdict. Real-time: yes, at most kStopSamples poses.
inline constexpr int kStopSamples = 12;
[[nodiscard]] hal::LimitSet LimitsPassed(const config::ServoConfig& config,
                                         const trajectory::Reference& reference, model::LazyPoses& now,
                                         KnownClearances& known) noexcept;

}  // namespace fovea::guard
