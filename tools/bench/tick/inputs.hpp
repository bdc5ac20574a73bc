// SPDX-License-Identifier: Apache-2.0
// Inputs of the servo, tick by tick, from several kinds of closed loop. The benchmark times the tick on them.
//
// The arm obeys its model (M ddq + C dq = tau). The camera measures without error, 40 ms late, at 30 Hz. No
// simulator is needed, so every build of the servo gets the same inputs.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/task/servo_task.hpp"

namespace fovea::bench {

struct TickCase {
  std::string name;
  config::ServoConfig config;
  std::vector<task::ServoInputs> inputs;  // one per tick
};

// The reference run: from Boot to the goal, 4 s.
TickCase TrackingCase(const model::ArmModel& arm);

// The same, but the target is lost: Coast, then Hold. At last the arm sends no state any more: Fault.
TickCase LossCase(const model::ArmModel& arm);

// The end effector follows commanded poses around a circle.
TickCase CommandedCase(const model::ArmModel& arm);

// Everything on (obstacles, null-space gains for joint limits and manipulability), random start, goal and
// target, 1.5 s.
TickCase RandomCase(const model::ArmModel& arm, unsigned seed);

}  // namespace fovea::bench
