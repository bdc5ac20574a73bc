// SPDX-License-Identifier: Apache-2.0
// Stage contact: estimates external torques, and checks that each encoder still follows its joint.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/task/check_inputs.hpp"
#include "firmware/core/task/servo_state.hpp"

namespace fovea::task {

struct ContactScene {
  bool sound = true;   // the arm's state is new and was accepted
  bool drives = true;  // the servo drives the arm
};

// Observes with the state of this tick. A joint whose encoder hangs, or that is pushed too hard, becomes the
// fault in `check`, unless there is one. Sets `state.blind` if an encoder hangs. Real-time: yes.
void CheckContact(const config::ServoConfig& config, const ContactScene& scene, ServoState& state,
                  InputCheck& check) noexcept;

}  // namespace fovea::task
