// Stage 2, contact: what pushes the arm, and whether each encoder still says where its joint is.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/task/check_inputs.hpp"
#include "firmware/core/task/servo_state.hpp"

namespace fovea::task {

struct ContactScene {
  bool sound = true;   // the arm's state is new, and was believed
  bool drives = true;  // the servo drives the arm
};

// Observes with the state of this tick. A joint whose encoder hangs, or that is pushed too hard, becomes the
// fault in `check`, unless there is one; `state.blind` says whether an encoder hangs. Real-time: yes.
void CheckContact(const config::ServoConfig& config, const ContactScene& scene, ServoState& state,
                  InputCheck& check) noexcept;

}  // namespace fovea::task
