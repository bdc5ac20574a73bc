// SPDX-License-Identifier: Apache-2.0
// One tick of all joints towards wished velocities, within their limits of acceleration and jerk.
//
// Joints that change their speed each as fast as it can arrive one after the other, and in between the arm
// moves in a direction that nobody wished: a hand that should move 10 mm/s along its axis turns by degrees
// per second. Together, a joint that alone would arrive after T_i takes about as long as the slowest, T: it
// gets the share T_i / T of its acceleration limit and (T_i / T)^2 of its jerk limit, with which a change
// from rest to rest takes exactly T. But it never accelerates by more than alone, so that it does not pass
// its wish.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::guard {

// Advances `reference` by one tick towards the velocities `dq`, which themselves change by `ddq`
// [num_joints]. Returns the limits that acted. Real-time: yes.
hal::LimitSet ApproachTogether(const config::ServoConfig& config, const model::VecN& dq,
                               const model::VecN& ddq, trajectory::Reference& reference) noexcept;

// The same, each joint by itself in the shortest time.
hal::LimitSet ApproachAlone(const config::ServoConfig& config, const model::VecN& dq, const model::VecN& ddq,
                            trajectory::Reference& reference) noexcept;

}  // namespace fovea::guard
