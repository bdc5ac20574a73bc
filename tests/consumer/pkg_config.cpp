// SPDX-License-Identifier: Apache-2.0
// The flags from `pkg-config fovea` are enough to compile and link the servo.
#include <cstdio>
#include <memory>

#include "fovea/servo_task.hpp"

int main() {
  const auto servo = std::make_unique<fovea::task::ServoTask>();
  // The library's own code must refuse a configuration without an arm.
  const bool refused = !servo->Init(fovea::config::ServoConfig{}).ok();
  std::printf("%s\n", refused ? "refused" : "accepted");
  return refused ? 0 : 1;
}
