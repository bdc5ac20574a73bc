// SPDX-License-Identifier: Apache-2.0
// Checks of a configuration before the task accepts it.
#include <cmath>
#include <memory>

#include "firmware/core/config/range_check.hpp"
#include "firmware/core/features/hold_orientation.hpp"
#include "firmware/core/guard/motor_need.hpp"
#include "firmware/core/model/ready_inertia.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/core/task/servo_task.hpp"

namespace fovea::task {
namespace {

using hal::Status;
using hal::StatusCode;

bool IsPositive(double x) noexcept { return x > 0.0 && std::isfinite(x); }

Status CheckArmModel(const model::ArmModel& arm) noexcept {
  if (arm.num_joints < 1 || arm.num_joints > model::kMaxJoints) {
    return Status(StatusCode::kInvalidArgument, "arm.num_joints");
  }
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    const model::LinkInertia& link = arm.links[k];
    if (!(joint.q_min < joint.q_max) || !std::isfinite(joint.q_min) || !std::isfinite(joint.q_max)) {
      return Status(StatusCode::kOutOfRange, "joint position range");
    }
    if (!IsPositive(joint.dq_max) || !IsPositive(joint.ddq_max) || !IsPositive(joint.dddq_max)) {
      return Status(StatusCode::kOutOfRange, "joint velocity, acceleration or jerk limit");
    }
    if (!IsPositive(joint.tau_max) || !IsPositive(joint.dtau_max)) {
      return Status(StatusCode::kOutOfRange, "joint torque limit");
    }
    if (!IsPositive(link.mass) || !link.p_LiCom.allFinite() || !link.I_Com_Li.allFinite()) {
      return Status(StatusCode::kOutOfRange, "link inertia");
    }
    if (!joint.X_PJ.p.allFinite() || !joint.X_PJ.R.allFinite()) {
      return Status(StatusCode::kNonFinite, "joint frame");
    }
    if (!(joint.viscous >= 0.0 && joint.coulomb >= 0.0 && joint.spring >= 0.0)) {
      return Status(StatusCode::kOutOfRange, "joint friction or spring");
    }
    if (!(joint.rotor_inertia >= 0.0 && std::isfinite(joint.rotor_inertia))) {
      return Status(StatusCode::kOutOfRange, "rotor inertia");
    }
  }
  return Status::Ok();
}

// A body that is not finite would count as far from everything.
Status CheckArmShape(const model::ArmModel& arm) noexcept {
  for (const model::Capsule& body : arm.shape.bodies) {
    if (!body.p_LA.allFinite() || !body.p_LB.allFinite() || !(body.radius >= 0.0) ||
        !std::isfinite(body.radius)) {
      return Status(StatusCode::kOutOfRange, "arm.shape.bodies");
    }
  }
  if (arm.shape.num_pairs < 0 || arm.shape.num_pairs > model::ArmShape::kMostPairs) {
    return Status(StatusCode::kInvalidArgument, "arm.shape.num_pairs");
  }
  for (int k = 0; k < arm.shape.num_pairs; ++k) {
    const model::ArmShape::Pair& pair = arm.shape.pairs[static_cast<std::size_t>(k)];
    if (!(0 <= pair.near && pair.near < pair.far && pair.far <= arm.num_joints)) {
      return Status(StatusCode::kInvalidArgument, "arm.shape.pairs");
    }
  }
  return Status::Ok();
}

// Computes the feature at its goal, plus orientation-hold rows if enabled, into `goal`.
Status ComputeGoal(const features::TargetFeature& feature, features::FeatureState& goal) noexcept {
  if (!(feature.p_CO_C_star.z() >= feature.radius)) {
    return Status(StatusCode::kOutOfRange, "servo.goal");
  }
  if (!feature.IsListed()) {
    return Status(StatusCode::kInvalidArgument, "servo.feature");
  }
  if (!feature.ComputeAtGoal(goal)) {
    return Status(StatusCode::kOutOfRange, "servo.goal");
  }
  features::FeatureState held;
  if (feature.hold_orientation &&
      (!features::HoldOrientation{}.Compute(model::Mat3::Identity(), held) || !features::Stack(held, goal))) {
    return Status(StatusCode::kInvalidArgument, "servo.hold_orientation");
  }
  return Status::Ok();
}

bool IsSound(const config::Box& box) noexcept { return (box.low.array() < box.high.array()).all(); }

Status CheckGuard(const config::GuardConfig& guard) noexcept {
  if (!(guard.workspace_margin < guard.workspace_radius)) {
    return Status(StatusCode::kOutOfRange, "safety.workspace_margin");
  }
  const config::ViewConfig& view = guard.view;
  if (view.enabled && !(view.x_min < view.x_max && view.y_min < view.y_max)) {
    return Status(StatusCode::kOutOfRange, "safety.view_margin_px");
  }
  for (int i = 0; i < guard.obstacles.num_planes; ++i) {
    if (!(std::fabs(guard.obstacles.planes[static_cast<std::size_t>(i)].normal.norm() - 1.0) < 1e-9)) {
      return Status(StatusCode::kOutOfRange, "safety.planes");
    }
  }
  for (int i = 0; i < guard.obstacles.num_boxes; ++i) {
    if (!IsSound(guard.obstacles.boxes[static_cast<std::size_t>(i)])) {
      return Status(StatusCode::kOutOfRange, "safety.boxes");
    }
  }
  for (int i = 0; i < guard.hand.num_balls; ++i) {
    if (!IsPositive(guard.hand.balls[static_cast<std::size_t>(i)].radius)) {
      return Status(StatusCode::kOutOfRange, "safety.tools");
    }
  }
  return Status::Ok();
}

// Checks values that are each in range but must also fit together.
Status CheckTogether(const config::ServoConfig& config) noexcept {
  if (!config::IsStaleBeforeLost(config.predict)) {
    return Status(StatusCode::kOutOfRange, "servo.stale_s");
  }
  if (!config::IsPossible(config.load)) {
    return Status(StatusCode::kOutOfRange, "servo.load_offset");
  }
  // Half of the stability limit of the joints' error (Routh), so that the true gain may be twice as large.
  if (!(config.motion_law.integral <= config.motion_law.zeta * config.motion_law.omega_n)) {
    return Status(StatusCode::kOutOfRange, "servo.integral");
  }
  if (!IsSound(config.predict.target_region)) {
    return Status(StatusCode::kOutOfRange, "servo.target_region");
  }
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    if (!(2.0 * config.guard.joint_position_margin < joint.q_max - joint.q_min)) {
      return Status(StatusCode::kOutOfRange, "safety.joint_position_margin");
    }
  }
  switch (motion_laws::FitnessOf(config.motion_law, config.arm, config.motion_law.kind).why) {
    case motion_laws::Unfit::kNone: break;
    case motion_laws::Unfit::kTooFewJoints: return Status(StatusCode::kInvalidArgument, "servo.motion_law");
    case motion_laws::Unfit::kDampedTooFast:
      return Status(StatusCode::kOutOfRange,
                    motion_laws::EntryOf(config.motion_law.kind).has_springs ? "servo.k_v" : "servo.zeta");
  }
  if (!(model::InertiaAtReady(config.arm).coupling.maxCoeff() <= model::kCouplingMost)) {
    return Status(StatusCode::kOutOfRange, "arm.load_mass");
  }
  if (const guard::MotorNeed need = guard::LargestMotorNeed(config); !(need.torque <= need.allowed)) {
    return Status(StatusCode::kOutOfRange, "safety.torque_fraction");
  }
  return CheckGuard(config.guard);
}

}  // namespace

Status ServoTask::Init(const config::ServoConfig& config) noexcept {
  if (const Status status = CheckArmModel(config.arm); !status.ok()) {
    return status;
  }
  if (const Status status = CheckArmShape(config.arm); !status.ok()) {
    return status;
  }
  config::RangeCheck ranges;
  config::Fields(ranges, config);
  if (!ranges.status().ok()) {
    return ranges.status();
  }
  if (const Status status = CheckTogether(config); !status.ok()) {
    return status;
  }
  features::FeatureState goal;
  if (const Status status = ComputeGoal(config.feature, goal); !status.ok()) {
    return status;
  }

  config_ = config;
  goal_ = goal;
  std::construct_at(&state_);  // in place, without a temporary: it is large, and a stack may be small
  const int n = config.arm.num_joints;
  state_.mode.track_asked = config.auto_track;
  for (const motion_laws::MotionLawEntry& law : motion_laws::kMotionLaws) {
    may_drive_[static_cast<std::size_t>(law.kind)] =
        motion_laws::FitnessOf(config.motion_law, config.arm, law.kind).why == motion_laws::Unfit::kNone;
  }
  state_.law_state.Reset(config.motion_law.kind, n);
  state_.contact.Reset(n, CarriesLoads());
  for (model::VecN* v :
       {&state_.q, &state_.dq, &state_.tau_applied, &state_.tau, &state_.tau_before, &state_.reference.q,
        &state_.reference.dq, &state_.reference.ddq, &state_.motion.off}) {
    v->setZero(n);
  }
  return Status::Ok();
}

}  // namespace fovea::task
