// How a reference comes to rest when every joint brakes as hard as it may, and where that leads.
//
// Each joint's velocity goes to zero in the shortest time that its acceleration and jerk limits allow
// (velocity_change.hpp). The joints stop at different times, so the end effector's way is none that was
// planned; it is looked at point by point.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

// The limits that a stop from `reference` would pass: the joints' range, the workspace, an obstacle before
// the hand or before the links, the arm itself, each with its margin, and the hand's speed and that
// of its turn, which joints that stop one after the other can take beyond what they are; 0 when it stays
// clear of all. What is already past one may only come back. `q_now` are the joints of the reference before,
// `poses_now` those of its links. Real-time: yes, at most kStopSamples poses.
inline constexpr int kStopSamples = 12;
[[nodiscard]] hal::LimitSet LimitsPassed(const config::ServoConfig& config,
                                         const trajectory::Reference& reference, const model::VecN& q_now,
                                         const model::ArmPoses& poses_now) noexcept;

}  // namespace fovea::guard
