// SPDX-License-Identifier: Apache-2.0
// Resets the state that starts anew with each mode.
#pragma once

#include "firmware/core/task/servo_state.hpp"

namespace fovea::task {

struct ModeChange {
  int num_joints = 0;
  bool carries_loads = false;  // the active motion law compensates unknown loads
  hal::Mode before = hal::Mode::kBoot;
};

// Changes from `change.before` to the mode that `state` has now. Real-time: yes.
void EnterMode(const ModeChange& change, ServoState& state) noexcept;

// Clears the last resolution, which is no longer valid once something else has moved the arm. Real-time: yes.
void ForgetMotion(ServoState& state) noexcept;

}  // namespace fovea::task
