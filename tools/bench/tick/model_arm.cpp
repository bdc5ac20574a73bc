// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/model_arm.hpp"

#include "firmware/core/model/cholesky.hpp"

namespace fovea::bench {
namespace {

constexpr double kTickS = 1e-3;

}  // namespace

void ModelArm::Tick(const hal::ArmCommand& command) noexcept {
  tau_ = model::ToVector(command.tau_cmd, arm_.num_joints);
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(arm_, q_, poses);
  model::ComputeDynamics(arm_, poses, dq_, dynamics);
  model::VecN ddq = tau_ - dynamics.Cdq;
  model::FactorCholesky(dynamics.M);
  model::SolveLower(dynamics.M, ddq);
  model::SolveLowerTransposed(dynamics.M, ddq);
  dq_ += kTickS * ddq;
  q_ += kTickS * dq_;
  ++tick_;
}

hal::ArmState ModelArm::State() const noexcept {
  hal::ArmState state;
  state.sequence = tick_;
  state.stamp_ns = static_cast<std::int64_t>(tick_) * hal::kTickPeriodNs;
  state.num_joints = arm_.num_joints;
  state.q = model::ToArray(q_);
  state.dq = model::ToArray(dq_);
  state.tau_applied = model::ToArray(tau_);
  return state;
}

config::ServoConfig DefaultConfig(const model::ArmModel& arm) {
  config::ServoConfig config;
  config.arm = arm;
  config.X_EC.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  config.X_EC.p = {0.05, 0.0, 0.04};
  config.law.q_posture = arm.q_ready;
  config.auto_track = true;
  return config;
}

model::Pose CameraAt(const config::ServoConfig& config, const model::VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses.X_BE * config.X_EC;
}

hal::FeatureMeasurement Measure(const config::ServoConfig& config, const ModelArm& arm,
                                const model::Vec3& p_BO) {
  hal::FeatureMeasurement m;
  m.stamp_ns = arm.State().stamp_ns;
  m.sequence = arm.State().sequence;
  m.found = true;
  m.confidence = 1.0;
  m.dim = 3;
  const model::Vec3 s = CameraAt(config, arm.q()).Inverse() * p_BO / config.feature.radius;
  for (std::size_t i = 0; i < 3; ++i) {
    m.s[i] = s[static_cast<Eigen::Index>(i)];
    m.cov_s[i * hal::kMaxFeatureDim + i] = 1e-6;
  }
  return m;
}

}  // namespace fovea::bench
