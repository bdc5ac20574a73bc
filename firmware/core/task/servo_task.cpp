#include "firmware/core/task/servo_task.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/keep_apart.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/features/hold_orientation.hpp"
#include "firmware/core/guard/clamp_torque.hpp"
#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::task {
namespace {

constexpr double kTargetMovedM = 0.02;       // so far from where it was unreachable, and it is tried again
constexpr double kGoalNearFraction = 0.005;  // errors below this share of |s_star| count as there
constexpr double kBehind = 0.2;     // a stop that is so much behind what it should be is none [rad/s, m/s]
constexpr double kStopShare = 0.3;  // of safety.fault_damping: what it should be at least
constexpr double kBootShare = 0.5;  // of a joint's velocity limit in Boot, where nothing shall move it
constexpr double kSecondNs = static_cast<double>(hal::kNsPerSecond);
constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
constexpr double kOffShare = kPeriodS / 0.25;  // of a tick in the mean by which a motion is not followed

bool IsTracking(hal::Mode mode) noexcept { return mode == hal::Mode::kTrack || mode == hal::Mode::kCoast; }

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
  Done(Stage::kCheck);
  ComputeModel();
  Done(Stage::kModel);
  CheckContact(inputs.missed_ticks, check.fault, check.joint);
  Done(Stage::kContact);
  PredictFeature(inputs, check.fault);
  Done(Stage::kPredict);
  ChooseMode(inputs, check);
  Done(Stage::kModes);
  ComputeVisualLaw();
  Done(Stage::kVisualLaw);
  MoveReference(inputs);
  Done(Stage::kReference);
  ComputeTorque(inputs);
  Done(Stage::kMotionLaw);
  Clamp();
  Done(Stage::kClamp);
  WriteRecord(inputs, outputs.record);
  Done(Stage::kRecord);
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

void ServoTask::ComputeVisualLaw() noexcept {
  state_.feature_valid = state_.prediction.known && ComputeFeature();
  if (state_.feature_valid) {
    control::ChooseInteraction(config_.law, goal_.L_s, state_.feature);
    config::LawConfig law = config_.law;
    if (state_.way.preferred && state_.way.goal.found) {
      law.q_posture = model::ToArray(state_.way.goal.q);
    }
    control::VisualLaw(law, config_.arm, state_.feature, state_.J_C, state_.q, state_.law);
    if (IsTracking(state_.mode.mode) && control::SeeksGoalPosture(config_)) {
      ChooseTheWay();
    }
  }
}

void ServoTask::ChooseTheWay() noexcept {
  control::WaySight sight{
      {state_.prediction.R_BO, state_.prediction.p_BO}, state_.prediction.seen.X_CO, state_.q};
  sight.limits = state_.limits;
  sight.now_ns = state_.now_ns;
  sight.track_since_ns = state_.track_since_ns;
  sight.is_told_apart = !config_.feature.SeesOrientation() || state_.predict.poses.num_branches == 1;
  control::ChooseWay(config_, sight, state_.way);
  if (state_.way.by_joints) {
    control::SteerByJoints(state_.way, state_.q, state_.prediction.seen, state_.J_C,
                           config_.feature.p_CO_C_star, state_.law.task);
  }
}

// The target's feature, and what is stacked below it.
bool ServoTask::ComputeFeature() noexcept {
  features::TargetInCamera seen = state_.prediction.seen;
  if (state_.way.goal.turn != 0) {
    seen.X_CO.R = seen.X_CO.R * control::QuarterTurns(state_.way.goal.turn);
  }
  if (!config_.feature.Compute(seen, state_.feature)) {
    return false;
  }
  if (!config_.feature.hold_orientation) {
    return true;
  }
  features::FeatureState held;
  const features::HoldOrientation orientation{IsTracking(state_.mode.mode) ? state_.R_BC_held
                                                                           : state_.X_BC.R};
  return orientation.Compute(state_.X_BC.R, held) && features::Stack(held, state_.feature);
}

void ServoTask::MoveReference(const ServoInputs& inputs) noexcept {
  state_.limits = 0;
  const bool floats = state_.law_state.kind == config::MotionLawKind::kFloat;
  if (state_.mode.mode == hal::Mode::kFault || floats) {
    state_.reference.q = state_.q;
    state_.reference.dq.setZero();
    state_.reference.ddq.setZero();
    ForgetMotion();
    return;
  }
  if (state_.inputs.bad_ticks > 0) {
    return;  // nothing new is known: the last command stays in force
  }
  if (state_.mode.mode == hal::Mode::kBoot && !state_.holds) {
    if (state_.inputs.sound_ticks == 0) {
      return;
    }
    // The servo takes the arm over where it is, as fast as it is, and brings it to rest.
    state_.reference.q = state_.q;
    state_.reference.dq = state_.dq;
    state_.reference.ddq.setZero();
    state_.holds = true;
  }
  if (state_.mode.mode == hal::Mode::kMove) {
    state_.limits =
        moves::FollowMotion(config_, inputs.motion, state_.now_ns, state_.motion, state_.reference);
    CheckFollowing();
    state_.motion.off += kOffShare * (state_.reference.q - state_.q - state_.motion.off);
    return;
  }
  guard::MotionWish wish;
  if (IsTracking(state_.mode.mode) && state_.feature_valid) {
    const std::int64_t since_ns = std::max(state_.track_since_ns, state_.way.since_ns);
    const double since_s = static_cast<double>(state_.now_ns - since_ns) / kSecondNs;
    const double blend = trajectory::SmoothStep(since_s / config_.law.smooth_start_s);
    state_.law.task.v *= blend;
    state_.law.task.dq_0 *= blend;
    barriers::ViewedTarget target{config_.feature.Outline(), state_.prediction.seen, state_.J_C};
    if (state_.predict.disc.started) {
      target.normal_C = state_.X_BC.R.transpose() * state_.predict.disc.normal_B;
    }
    control::ResolveMotion(
        config_, state_.law.task,
        {state_.reference, state_.poses, state_.J_E_B, state_.J_C, &target, state_.way.by_joints},
        state_.resolved);
    if (!state_.resolved.finite || !state_.resolved.dq.allFinite()) {
      LatchFault(hal::Fault::kNonFiniteControl, -1);
      return;
    }
    wish = guard::MotionWish::Velocity(state_.resolved.dq);
    state_.limits = state_.resolved.limits;
  } else {
    wish = guard::StopTogether(config_, state_.reference);
  }
  model::ArmPoses reference_poses;
  model::ComputePoses(config_.arm, state_.reference.q, reference_poses);
  if (state_.mode.mode == hal::Mode::kBoot && !IsOutside()) {
    state_.limits |= hal::Bit(hal::Limit::kObstacle);  // why Boot goes on
  }
  state_.limits |=
      guard::GuardMotion(config_, wish, state_.poses.X_BE.p, state_.J_E_B, reference_poses, state_.reference);
  CheckFollowing();
  NoteBlocked();
  NoteSteering();
}

void ServoTask::CheckFollowing() noexcept {
  const model::VecN following_error = state_.reference.q - state_.q;
  for (int i = 0; i < following_error.size(); ++i) {
    if (!(std::fabs(following_error[i]) <= config_.safety.following_error)) {
      LatchFault(hal::Fault::kNotFollowing, i);
      return;
    }
  }
}

// For how long limits have kept the arm from the goal.
void ServoTask::NoteBlocked() noexcept {
  const bool steering = IsTracking(state_.mode.mode) && state_.feature_valid;
  bool blocked = false;
  if (steering && state_.way.by_joints) {
    blocked = control::NoteHeld(state_.law.task, state_.reference.dq, state_.way);
  } else if (steering && (state_.limits & control::kBarriers) != 0) {
    blocked = state_.law.e.norm() > kGoalNearFraction * state_.feature.s_star.norm() &&
              control::Progress(state_.feature, state_.law.ds_cmd, state_.J_C, state_.reference.dq) <
                  config_.law.unreachable_progress;
  }
  // Noise lets it through for a tick now and then: what counts is how often it is kept.
  control::CountTick(blocked, state_.blocked_ns);
}

// Whether steering by what is seen brings the goal nearer. A way by the joints may lead away from it at
// first.
void ServoTask::NoteSteering() noexcept {
  if (!IsTracking(state_.mode.mode) || !state_.feature_valid || state_.way.by_joints) {
    return;
  }
  const model::Vec6 V_BC_C = state_.J_C.lazyProduct(state_.reference.dq);
  estimate::WatchSteering(config_.predict, state_.law.e.norm() / state_.feature.s_star.norm(),
                          V_BC_C.head<3>().norm(), state_.eye);
}

void ServoTask::ComputeTorque(const ServoInputs& inputs) noexcept {
  const motion_laws::MotionLawInputs law_inputs{config_.arm,      state_.poses, state_.dynamics,
                                                state_.reference, state_.q,     state_.dq};
  const auto law = static_cast<std::size_t>(inputs.law);
  if (inputs.change_law && config_.arm.num_joints >= motion_laws::kMotionLaws[law].joints_min) {
    motion_laws::ChangeMotionLaw(config_.motion_law, law_inputs, inputs.law, state_.law_state);
  }
  switch (state_.mode.mode) {
    case hal::Mode::kBoot:
      if (!state_.holds) {
        state_.tau.setZero(config_.arm.num_joints);
        state_.law_state.Reset(state_.law_state.kind, config_.arm.num_joints);
        break;
      }
      [[fallthrough]];
    case hal::Mode::kHold:
    case hal::Mode::kTrack:
    case hal::Mode::kCoast:
    case hal::Mode::kMove:
      if (state_.inputs.bad_ticks == 0) {
        motion_laws::MotionLaw(config_.motion_law, law_inputs, state_.law_state, state_.tau);
        estimate::CarryLoad(
            {config_.arm, config_.safety.stiction_fraction, config_.safety.carried_torque_fraction, Stands()},
            state_.contact, state_.tau);
      }
      break;
    case hal::Mode::kFault: StopDamped(); break;
  }
}

// Whether the law in force is one that holds the arm where it is, whatever hangs on it, and does not learn
// the load by itself.
bool ServoTask::CarriesLoads() const noexcept {
  return config_.safety.carried_torque_fraction > 0.0 && config_.motion_law.integral == 0.0 &&
         motion_laws::kMotionLaws[static_cast<std::size_t>(state_.law_state.kind)].carries;
}

// Whether the arm is to stand, and with what hangs on it.
bool ServoTask::Stands() const noexcept {
  const bool may_stand = state_.mode.mode == hal::Mode::kBoot || state_.mode.mode == hal::Mode::kHold;
  return may_stand && CarriesLoads() && state_.reference.dq.isZero(0.0);
}

void ServoTask::StopDamped() noexcept {
  // A damped stop needs true velocities; without them only the brakes are left.
  const bool blind = state_.inputs.bad_ticks > 0 || state_.inputs.non_finite_ticks > 0 ||
                     state_.inputs.jumped || state_.blind || state_.mode.fault == hal::Fault::kArmStale;
  const double since_s = static_cast<double>(state_.now_ns - state_.mode_since_ns) / kSecondNs;
  // Nor does damping stop a joint whose motor is dead, or that is pushed: the arm gets faster again, or no
  // slower.
  const double speed = state_.dq.lpNorm<Eigen::Infinity>();
  const double falls = 1.0 - kStopShare * config_.safety.fault_damping * kPeriodS;
  state_.stop_speed = std::min(falls * state_.stop_speed, speed);
  const bool in_vain = speed > state_.stop_speed + kBehind;
  if (blind || in_vain || since_s > config_.safety.brake_after_s || speed < config_.safety.brake_velocity) {
    state_.give_up = true;
  }
  motion_laws::DampedStop(config_.safety.fault_damping, state_.dynamics, state_.dq, state_.tau);
  if (state_.give_up) {
    state_.tau.setZero();
  }
}

void ServoTask::Clamp() noexcept {
  // The rate counts from what the arm says is in force; when it says nothing that can be, from what was sent
  // last. So it does behind closed brakes: what an arm then applies is its own way to hold itself.
  model::VecN in_force = state_.tau_applied;
  const bool told = state_.inputs.bad_ticks == 0 && state_.inputs.non_finite_ticks == 0;
  const bool behind_brakes = state_.braked && state_.give_up;
  for (int i = 0; i < in_force.size(); ++i) {
    const double tau_max = config_.arm.joints[static_cast<std::size_t>(i)].tau_max;
    if (!told || behind_brakes || std::fabs(in_force[i]) > tau_max) {
      in_force[i] = state_.tau_before[i];
    }
  }
  state_.law_state.cut = state_.tau;
  const guard::ClampResult result = guard::ClampTorque(config_.arm, config_.safety, in_force, state_.tau);
  state_.law_state.cut -= state_.tau;
  state_.limits |= result.limits;
  state_.braked = state_.give_up && (state_.tau.array() == 0.0).all();
  if (!result.finite) {
    LatchFault(hal::Fault::kNonFiniteControl, -1);
  }
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
