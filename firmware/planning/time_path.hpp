// SPDX-License-Identifier: Apache-2.0
// Turns the fastest motion along a path into a plan whose jerk is limited, too.
//
// The fastest motion changes its acceleration at once. Each control point of the plan is its mean over the
// last T = max 2 A / J seconds. A mean keeps every bound of velocity and acceleration. Its jerk is the change
// of the acceleration over T, divided by T: at most 2 A / T <= J. So all limits hold by construction, and the
// arm follows the path to within A T^2 / 24, a few mrad. The proof (motion_proof.hpp) is of the plan itself.
#pragma once

#include "firmware/planning/path_speed.hpp"

namespace fovea::planning {

// The joints' limits that a plan may use: the guard's, less a share that is left to the tick's corrections.
[[nodiscard]] JointLimits LimitsOfPlan(const config::ServoConfig& config) noexcept;

// How long before a time of a plan the fastest motion was at that place, about [s].
[[nodiscard]] double LagOf(const JointLimits& limits, int num_joints, double period_s) noexcept;

// Fills in the control points. `speed`: after Run(), which took `duration_s`.
void TimePath(const SmoothPath& path, const PathSpeed& speed, double duration_s, const JointLimits& limits,
              trajectory::Plan& plan) noexcept;

}  // namespace fovea::planning
