// What begins anew when the mode changes.
#pragma once

#include "firmware/core/task/servo_state.hpp"

namespace fovea::task {

struct ModeChange {
  int num_joints = 0;
  bool carries_loads = false;  // the motion law in force is one that carries what hangs on the arm
  hal::Mode before = hal::Mode::kBoot;
};

// From `change.before` to the mode that `state` has now. Real-time: yes.
void EnterMode(const ModeChange& change, ServoState& state) noexcept;

// What the last resolution knew of the posture holds no longer once something else has moved the arm.
// Real-time: yes.
void ForgetMotion(ServoState& state) noexcept;

}  // namespace fovea::task
