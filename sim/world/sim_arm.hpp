// SPDX-License-Identifier: Apache-2.0
// The simulated arm as a hal::Arm.
#pragma once

#include "fovea/hal/arm.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class SimArm final : public hal::Arm {
 public:
  explicit SimArm(World& world) : Arm(world.num_joints(), /*paces_loop=*/false), world_(world) {}

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state = world_.MeasuredState();
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    world_.Command(command);
    return hal::Status::Ok();
  }

  World& world_;
};

}  // namespace fovea::sim
