// SPDX-License-Identifier: Apache-2.0
// The tick, stage by stage, and its first stages: from the arm's sensors to the mode.
#include "firmware/core/task/servo_task.hpp"

#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/task/check_contact.hpp"
#include "firmware/core/task/enter_mode.hpp"

namespace fovea::task {
namespace {

constexpr double kBootShare = 0.5;  // of a joint's velocity limit, in Boot, where nothing should move it

bool IsFinite(const hal::FeatureMeasurement& feature) noexcept {
  for (std::size_t i = 0; i < feature.s.size(); ++i) {
    if (!std::isfinite(feature.s[i])) {
      return false;
    }
  }
  for (std::size_t i = 0; i < feature.cov_s.size(); ++i) {
    if (!std::isfinite(feature.cov_s[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace

void ServoTask::Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept {
  InputCheck check;
  state_.tau_before = state_.tau;
  if (inputs.tuning.IsAsked() || state_.tuning.active) {
    Tune(inputs.tuning, config_, state_.tuning);
  }
  CheckArm(inputs, check);
  MarkStageEnd(Stage::kCheck);
  ComputeModel();
  MarkStageEnd(Stage::kModel);
  WatchForContact(inputs.missed_ticks, check);
  MarkStageEnd(Stage::kContact);
  PredictFeature(inputs, check.fault);
  MarkStageEnd(Stage::kPredict);
  ChooseMode(inputs, check);
  MarkStageEnd(Stage::kModes);
  ComputeVisualLaw(inputs.plan);
  MarkStageEnd(Stage::kVisualLaw);
  MoveReference(inputs);
  MarkStageEnd(Stage::kReference);
  ComputeTorque(inputs);
  MarkStageEnd(Stage::kMotionLaw);
  Clamp();
  MarkStageEnd(Stage::kClamp);
  WriteRecord(inputs, outputs.record);
  MarkStageEnd(Stage::kRecord);
  ++state_.tick;
}

void ServoTask::CheckArm(const ServoInputs& inputs, InputCheck& check) noexcept {
  const int n = config_.arm.num_joints;
  const double share = state_.mode.mode == hal::Mode::kBoot ? kBootShare : 1.0;
  check = CheckInputs(config_, inputs.arm_status, inputs.arm, inputs.missed_ticks, share, state_.inputs);
  state_.q = model::ToVector(state_.inputs.q, n);
  state_.dq = model::ToVector(state_.inputs.dq, n);
  state_.tau_applied = model::ToVector(state_.inputs.tau_applied, n);
  state_.now_ns = state_.inputs.stamp_ns + state_.inputs.bad_ticks * hal::kTickPeriodNs;
}

void ServoTask::ComputeModel() noexcept {
  model::ComputePoses(config_.arm, state_.q, state_.poses);
  model::ComputeDynamics(config_.arm, state_.poses, state_.dq, state_.dynamics);
  if (config_.load.offset != 0.0) {
    model::AddPointMass(config_.arm, state_.poses, state_.dq, config::OffsetOf(config_.load),
                        state_.dynamics);
  }
  state_.X_BC = state_.poses.X_BE * config_.X_EC;
  model::ComputeJacobian(config_.arm, state_.poses, config_.X_EC, state_.J_C);
  model::ComputeLinearJacobian(config_.arm, state_.poses, state_.poses.X_BE.p, state_.J_E_B);
}

// Only while the servo drives the arm: people may push a floating arm.
void ServoTask::WatchForContact(std::int32_t missed_ticks, InputCheck& check) noexcept {
  const bool sound = missed_ticks == 0 && state_.inputs.bad_ticks == 0 &&
                     state_.inputs.non_finite_ticks == 0 && !state_.inputs.jumped;
  const bool drives = state_.mode.mode != hal::Mode::kFault &&
                      (state_.mode.mode != hal::Mode::kBoot || state_.holds) &&
                      state_.law_state.kind != config::MotionLawKind::kFloat;
  CheckContact(config_, {sound, drives}, state_, check);
}

void ServoTask::PredictFeature(const ServoInputs& inputs, hal::Fault& fault) noexcept {
  const bool new_state = state_.inputs.bad_ticks == 0 && state_.inputs.has_state;
  if (new_state) {
    state_.predict.history.Push(state_.now_ns, state_.q);
  }
  static_cast<void>(estimate::GoOn(config_.feature.corners, state_.predict.hypotheses));
  state_.intake = hal::Intake::kNone;
  if (inputs.has_feature && IsFinite(inputs.feature)) {
    state_.intake =
        estimate::TakeMeasurement(config_, state_.now_ns, inputs.feature, state_.predict, state_.eye);
  } else if (inputs.has_feature && fault == hal::Fault::kNone) {
    fault = hal::Fault::kNonFiniteFeature;
  }
  state_.prediction = estimate::Predict(config_, state_.now_ns, state_.X_BC, state_.predict);
}

void ServoTask::ChooseMode(const ServoInputs& inputs, const InputCheck& check) noexcept {
  ModeInputs mode_inputs;
  mode_inputs.request = inputs.request;
  mode_inputs.arm_ready = state_.inputs.sound_ticks >= config_.safety.boot_ticks &&
                          state_.dq.lpNorm<Eigen::Infinity>() < config_.safety.boot_velocity &&
                          (state_.mode.mode != hal::Mode::kBoot || IsOutside());
  mode_inputs.target_known = state_.prediction.known;
  mode_inputs.feature_age_ns = state_.prediction.age_ns;
  mode_inputs.goal_unreachable =
      control::HasNoWay(config_.law, state_.way) ||
      (control::IsUnreachable(config_.law, state_.reach) && !control::MayFindAWay(config_, state_.way));
  mode_inputs.may_try_again = control::HasMoved(state_.prediction.p_BO, state_.reach) ||
                              (state_.reach.planner_was_late && !state_.way.IsPlannerLate());
  mode_inputs.eye_doubted = state_.eye.doubted;
  mode_inputs.eye_suspected = state_.eye.suspected;
  moves::NoteAsked(config_, inputs.motion, state_.motion);
  const bool asked = inputs.motion.kind != moves::MotionKind::kNone && !state_.motion.HasArrived();
  mode_inputs.motion_asked = asked || state_.motion.IsUnderWay();
  mode_inputs.motion_refused = state_.motion.refused;
  mode_inputs.motion_not_followed = state_.motion.off.lpNorm<Eigen::Infinity>() > config_.safety.motion_error;
  mode_inputs.fault = check.fault;

  const hal::Mode before = state_.mode.mode;
  if (check.fault != hal::Fault::kNone && before != hal::Mode::kFault) {
    state_.fault_joint = check.joint;
  }
  if (!UpdateMode(config_.predict, mode_inputs, state_.mode)) {
    return;
  }
  EnterMode({config_.arm.num_joints, CarriesLoads(), before}, state_);
}

// In Boot: true if the arm is outside all planes and boxes. Inside, no stop can be proved.
bool ServoTask::IsOutside() const noexcept {
  return barriers::CountObstacles(config_.guard.obstacles) == 0 ||
         barriers::ClearanceOfArm(config_, state_.poses) > 0.0;
}

void ServoTask::LatchFault(hal::Fault fault, std::int32_t joint) noexcept {
  if (state_.mode.mode == hal::Mode::kFault) {
    return;
  }
  state_.mode.mode = hal::Mode::kFault;
  state_.mode.hold_reason = hal::HoldReason::kNone;
  state_.mode.fault = fault;
  state_.fault_joint = joint;
  state_.mode_since_ns = state_.now_ns;
  state_.way.Restart();
}

}  // namespace fovea::task
