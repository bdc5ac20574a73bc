#include "firmware/core/guard/motor_need.hpp"

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::guard {

MotorNeed LargestMotorNeed(const config::ServoConfig& config) noexcept {
  const model::ArmModel& arm = config.arm;
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(arm, model::ToVector(arm.q_ready, arm.num_joints), poses);
  model::ComputeDynamics(arm, poses, model::VecN::Zero(arm.num_joints), dynamics);
  MotorNeed largest;
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const MotorNeed need{i, dynamics.M(i, i) * config.guard.joint_acceleration_fraction * joint.ddq_max,
                         config.safety.torque_fraction * joint.tau_max};
    if (largest.joint < 0 || !(need.torque * largest.allowed <= largest.torque * need.allowed)) {
      largest = need;
    }
  }
  return largest;
}

}  // namespace fovea::guard
