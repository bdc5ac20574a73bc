// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/plan_request.hpp"

#include <algorithm>

#include "firmware/core/model/rotation.hpp"

namespace fovea::trajectory {
namespace {

constexpr std::int64_t kBudget = 200'000;  // of the first search; each further one has as much more
constexpr std::int32_t kMostBudgets = 3;   // so that the servo waits long enough

}  // namespace

bool HasGoalPosture(const config::ServoConfig& config) noexcept {
  const features::TargetFeature& feature = config.feature;
  const bool whole_pose = feature.SeesOrientation() && features::TakesWholePose(feature.form);
  const bool turns_freely = !feature.SeesOrientation() && !feature.hold_orientation;
  return config.arm.num_joints >= 6 && (whole_pose || turns_freely);
}

PlanRequest RequestOf(const hal::TickRecord& record) noexcept {
  const int n = record.command.num_joints;
  PlanRequest request;
  request.kind = record.way.way == hal::Way::kLaw ? PlanRequest::Kind::kHorizon : PlanRequest::Kind::kPlan;
  request.start.q = model::ToVector(record.q_cmd, n);
  request.start.dq = model::ToVector(record.dq_cmd, n);
  request.start.ddq = model::ToVector(record.ddq_cmd, n);
  request.q_off = model::ToVector(record.arm.q, n) - request.start.q;
  request.X_BO.p = {record.p_BO[0], record.p_BO[1], record.p_BO[2]};
  static_cast<void>(model::RotationOfQuaternion(record.q_BO, request.X_BO.R));  // on error: the identity
  request.v_BO = {record.v_BO[0], record.v_BO[1], record.v_BO[2]};
  request.normal_B = {record.way.normal_B[0], record.way.normal_B[1], record.way.normal_B[2]};
  request.stamp_ns = record.stamp_ns;
  request.seed = static_cast<std::uint64_t>(record.way.plans_asked);
  request.budget = kBudget * std::clamp<std::int32_t>(record.way.tries, 1, kMostBudgets);
  return request;
}

}  // namespace fovea::trajectory
