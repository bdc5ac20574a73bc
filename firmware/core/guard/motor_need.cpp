// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/motor_need.hpp"

#include "firmware/core/model/ready_inertia.hpp"

namespace fovea::guard {

MotorNeed LargestMotorNeed(const config::ServoConfig& config) noexcept {
  const model::ArmModel& arm = config.arm;
  const model::VecN inertia = model::InertiaAtReady(arm).held;
  MotorNeed largest;
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const MotorNeed need{i, inertia[i] * config.guard.joint_acceleration_fraction * joint.ddq_max,
                         config.safety.torque_fraction * joint.tau_max};
    if (largest.joint < 0 || !(need.torque * largest.allowed <= largest.torque * need.allowed)) {
      largest = need;
    }
  }
  return largest;
}

}  // namespace fovea::guard
