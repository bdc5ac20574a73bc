// What a servo was given, tick by tick, in closed loops of many kinds: the inputs on which its tick is timed.
//
// The arm obeys its model (M ddq + C dq = tau), the camera measures without error, 40 ms late at 30 Hz. No
// simulator is needed, so the same inputs come about wherever the servo is built.
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

// The same, until the target is lost: Coast, then Hold, and at last an arm that says nothing any more: Fault.
TickCase LossCase(const model::ArmModel& arm);

// The end effector follows commanded poses round a circle.
TickCase CommandedCase(const model::ArmModel& arm);

// Everything on (obstacles, singularity, wishes for the null space), random start, goal and target, 1.5 s.
TickCase RandomCase(const model::ArmModel& arm, unsigned seed);

}  // namespace fovea::bench
