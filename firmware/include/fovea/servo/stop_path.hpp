// How a reference comes to rest when every joint brakes as hard as it may, and where that leads.
//
// Each joint's velocity goes to zero in the shortest time that its acceleration and jerk limits allow
// (velocity_change.hpp). The joints stop at different times, so the end effector's way is none that was
// planned; it is looked at point by point.
#pragma once

#include "fovea/hal/events.hpp"
#include "fovea/model/types.hpp"
#include "fovea/servo/reference.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// The limits that a stop from `reference` would pass: the joints' range, the workspace, an obstacle, each
// with its margin; 0 when it stays clear of all. What is already past one may only come back. `p_now` is p_BE
// of the reference before [m], and `q_now` its joints. Real-time: yes, at most kStopSamples poses.
inline constexpr int kStopSamples = 12;
[[nodiscard]] hal::LimitSet LimitsPassed(const ServoConfig& config, const Reference& reference,
                                         const model::VecN& q_now, const model::Vec3& p_now) noexcept;

}  // namespace fovea::servo
