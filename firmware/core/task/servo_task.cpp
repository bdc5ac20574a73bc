// The tick, stage by stage, and what is known of the arm: from its sensors to the mode.
#include "firmware/core/task/servo_task.hpp"

#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/motion_laws/friction.hpp"

namespace fovea::task {
namespace {

constexpr double kTargetMovedM = 0.02;  // so far from where it was unreachable, and it is tried again
constexpr double kBootShare = 0.5;      // of a joint's velocity limit in Boot, where nothing shall move it
constexpr double kSecondNs = static_cast<double>(hal::kNsPerSecond);

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
  CheckArm(inputs, check);
  MarkStageEnd(Stage::kCheck);
  ComputeModel();
  MarkStageEnd(Stage::kModel);
  CheckContact(inputs.missed_ticks, check.fault, check.joint);
  MarkStageEnd(Stage::kContact);
  PredictFeature(inputs, check.fault);
  MarkStageEnd(Stage::kPredict);
  ChooseMode(inputs, check);
  MarkStageEnd(Stage::kModes);
  ComputeVisualLaw();
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
  state_.X_BC = state_.poses.X_BE * config_.X_EC;
  model::ComputeJacobian(config_.arm, state_.poses, config_.X_EC, state_.J_C);
  model::ComputeLinearJacobian(config_.arm, state_.poses, state_.poses.X_BE.p, state_.J_E_B);
}

// While the servo drives the arm; a floating arm is there to be pushed.
void ServoTask::CheckContact(std::int32_t missed_ticks, hal::Fault& fault, std::int32_t& joint) noexcept {
  const bool sound = missed_ticks == 0 && state_.inputs.bad_ticks == 0 &&
                     state_.inputs.non_finite_ticks == 0 && !state_.inputs.jumped;
  const bool drives = state_.mode.mode != hal::Mode::kFault &&
                      (state_.mode.mode != hal::Mode::kBoot || state_.holds) &&
                      state_.law_state.kind != config::MotionLawKind::kFloat;
  if (!sound || !drives) {
    state_.contact.started = false;
  } else {
    estimate::ObserveContact(config_.safety.contact_gain, state_.dynamics, state_.dq,
                             state_.tau_applied - motion_laws::SpringTorque(config_.arm, state_.q),
                             state_.contact);
  }
  if (!sound) {
    return;
  }
  const std::int32_t hangs = estimate::WatchEncoders(
      config_, {state_.q, state_.dq, state_.dynamics, state_.contact.residual, state_.reference.q, drives},
      state_.encoders);
  state_.blind = hangs >= 0;
  if (fault != hal::Fault::kNone) {
    return;
  }
  if (state_.blind) {
    fault = hal::Fault::kArmStale;
    joint = hangs;
    return;
  }
  for (int i = 0; drives && i < state_.contact.residual.size(); ++i) {
    const double most =
        config_.safety.contact_torque_fraction * config_.arm.joints[static_cast<std::size_t>(i)].tau_max;
    if (!(std::fabs(state_.contact.residual[i]) <= most)) {
      fault = hal::Fault::kContact;
      joint = i;
      return;
    }
  }
}

void ServoTask::PredictFeature(const ServoInputs& inputs, hal::Fault& fault) noexcept {
  const bool new_state = state_.inputs.bad_ticks == 0 && state_.inputs.has_state;
  if (new_state) {
    state_.predict.history.Push(state_.now_ns, state_.q);
  }
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
      static_cast<double>(state_.blocked_ns) > config_.law.unreachable_s * kSecondNs;
  mode_inputs.target_moved = (state_.prediction.p_BO - state_.p_BO_unreachable).norm() > kTargetMovedM;
  mode_inputs.eye_doubted = state_.eye.doubted;
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
  const hal::Mode now = state_.mode.mode;
  state_.mode_since_ns = state_.now_ns;
  if (now != hal::Mode::kMove) {
    state_.motion.Stop();
    state_.motion.refused = false;
    state_.motion.off.setZero(config_.arm.num_joints);
  }
  ForgetMotion();
  if (now == hal::Mode::kTrack && before == hal::Mode::kHold) {
    state_.track_since_ns = state_.now_ns;
    state_.blocked_ns = 0;
    state_.eye = estimate::EyeWatch{};
    state_.way = control::WayToGoal{};
    state_.R_BC_held = state_.X_BC.R;
  }
  if (now == hal::Mode::kHold) {
    state_.p_BO_unreachable = state_.prediction.p_BO;
    if (state_.mode.hold_reason == hal::HoldReason::kTargetLost) {
      state_.predict.Reset();
    }
  }
  if (now == hal::Mode::kBoot) {
    state_.inputs.sound_ticks = 0;
    state_.holds = false;
    state_.contact.Reset(config_.arm.num_joints, CarriesLoads());
    state_.encoders = estimate::EncoderWatch{};
    state_.fault_joint = -1;
    state_.give_up = false;
    state_.stop_speed = HUGE_VAL;
  }
}

// In Boot: whether the arm stands outside what it keeps out of. Within, nothing that it could do is proved.
bool ServoTask::IsOutside() const noexcept {
  return barriers::CountObstacles(config_.guard.obstacles) == 0 ||
         barriers::ClearanceOfArm(config_, state_.poses) > 0.0;
}

// What the last resolution knew of the posture holds no longer once something else has moved the arm.
void ServoTask::ForgetMotion() noexcept {
  state_.resolved = control::ResolvedMotion{};
  state_.motion.resolved = control::ResolvedMotion{};
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
}

}  // namespace fovea::task
