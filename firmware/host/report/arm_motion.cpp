// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/report/arm_motion.hpp"

#include "firmware/core/link/state.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/report/envelope.hpp"

namespace fovea::report {
namespace {

using Doubles = google::protobuf::RepeatedField<double>;

model::VecN VectorOf(const Doubles& values, int size) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

}  // namespace

ArmMotion::ArmMotion(const log::ServoConfiguration& message) : servo_(flight::FromMessage(message)) {}

ArmMotion::OfTick ArmMotion::At(const log::Tick& tick) const {
  OfTick motion{{kGap, kGap, kGap, kGap, kGap, kGap}, kGap};
  const int joints = servo_ ? servo_->arm.num_joints : 0;
  if (joints == 0 || tick.arm().q_size() < joints || tick.arm().dq_size() < joints) {
    return motion;
  }
  model::ArmPoses poses;
  model::ComputePoses(servo_->arm, VectorOf(tick.arm().q(), joints), poses);
  model::Mat6N J_C;
  model::ComputeJacobian(servo_->arm, poses, servo_->X_EC, J_C);
  const model::Vec6 V_BC_C = J_C * VectorOf(tick.arm().dq(), joints);
  for (int i = 0; i < 6; ++i) {
    motion.V_BC_C[static_cast<std::size_t>(i)] = static_cast<float>(V_BC_C[i]);
  }
  const std::string& bytes = tick.demand();
  link::Demand demand;
  if (link::Decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, demand) &&
      demand.motion.kind == moves::MotionKind::kPoseSetpoint) {
    const model::Vec3 off = poses.X_BE.p - Eigen::Map<const model::Vec3>(demand.motion.p_BE.data());
    motion.path_error_mm = static_cast<float>(1e3 * off.norm());
  }
  return motion;
}

}  // namespace fovea::report
