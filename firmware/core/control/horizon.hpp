// SPDX-License-Identifier: Apache-2.0
// The motion of a predictive law: along horizons that the planner beside the tick computes.
//
// While the law steers, the servo asks for a horizon every 40 ms (firmware/planning/horizon_search.hpp). It
// begins with the reference's motion at the time of the request, leads towards the goal with all limits ahead
// in view, and ends at rest. The arm follows the newest one and sees only its beginning. If none comes, it
// goes on along the last one for a while, and then by the law's own matrix, which also steers until the first
// one is there, while several poses of the target fit, and while the target moves: a horizon looks farther
// ahead than a motion on a curve can be foretold.
#pragma once

#include "firmware/core/control/way_to_goal.hpp"
#include "firmware/core/trajectory/plan_part.hpp"

namespace fovea::control {

// Asks for horizons, takes those that come, and sets way.horizon_ns. `plans`: all of the newest horizon, or a
// part of it. True if the arm follows one: then `step` has its motion in the next tick. Real-time: yes.
[[nodiscard]] bool FollowHorizon(const config::ServoConfig& config, const WaySight& sight,
                                 const trajectory::PlanReceiver& plans, WayToGoal& way,
                                 PlanStep& step) noexcept;

}  // namespace fovea::control
