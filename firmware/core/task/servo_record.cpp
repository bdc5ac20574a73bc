// SPDX-License-Identifier: Apache-2.0
// Writes the record of a tick: its inputs, the intermediate results, and the command.
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/task/servo_task.hpp"

namespace fovea::task {

void ServoTask::WriteRecord(const ServoInputs& inputs, hal::TickRecord& record) const noexcept {
  record = hal::TickRecord{};
  record.tick = state_.tick;
  record.stamp_ns = state_.now_ns;
  record.missed_ticks = inputs.missed_ticks;
  record.arm = inputs.arm;
  record.has_feature = inputs.has_feature;
  record.feature = inputs.feature;
  record.intake = state_.intake;
  record.tuning = state_.tuning.note;

  record.mode = state_.mode.mode;
  record.hold_reason = state_.mode.hold_reason;
  record.fault = state_.mode.fault;
  record.fault_joint = state_.fault_joint;
  record.limits_active = state_.limits;

  record.target_known = state_.prediction.known;
  record.feature_age_ns = state_.prediction.age_ns;
  for (std::size_t i = 0; i < 3; ++i) {
    record.p_BO[i] = state_.prediction.p_BO[static_cast<Eigen::Index>(i)];
    record.v_BO[i] = state_.prediction.v_BO[static_cast<Eigen::Index>(i)];
  }
  record.stamp_late_s = state_.prediction.late.mean_s;
  record.stamp_late_sigma_s = state_.prediction.late.sigma_s;
  if (state_.prediction.known) {
    record.q_BO = model::QuaternionOf(state_.prediction.R_BO);
  }
  if (state_.feature_valid) {
    record.dim = static_cast<std::int32_t>(state_.feature.s.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(record.dim); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      record.s[i] = state_.feature.s[k];
      record.s_star[i] = state_.feature.s_star[k];
      record.e[i] = state_.law.e[k];
    }
  }
  record.way = state_.way.note;
  const model::Vec6 V_BC_C_cmd = state_.J_C.lazyProduct(state_.reference.dq);
  for (std::size_t i = 0; i < 6; ++i) {
    record.V_BC_C_cmd[i] = V_BC_C_cmd[static_cast<Eigen::Index>(i)];
  }
  record.q_cmd = model::ToArray(state_.reference.q);
  record.dq_cmd = model::ToArray(state_.reference.dq);
  record.ddq_cmd = model::ToArray(state_.reference.ddq);
  record.tau_ext = model::ToArray(state_.contact.residual);

  record.command.state_sequence = state_.inputs.sequence;
  record.command.num_joints = config_.arm.num_joints;
  record.command.tau_cmd = model::ToArray(state_.tau);
  record.command.engage_brakes = state_.stop.stage == guard::FaultStop::Stage::kBraked;
}

}  // namespace fovea::task
