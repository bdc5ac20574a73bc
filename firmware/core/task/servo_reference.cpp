// SPDX-License-Identifier: Apache-2.0
// The stages that decide where the arm moves: the visual law and the reference.
#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/control/goal_size.hpp"
#include "firmware/core/control/horizon.hpp"
#include "firmware/core/features/equal_turn.hpp"
#include "firmware/core/features/hold_orientation.hpp"
#include "firmware/core/guard/following.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/task/enter_mode.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::task {
namespace {

constexpr double kOffShare = hal::kTickPeriodS / 0.25;  // of a tick in the mean deviation from a motion

bool IsTracking(hal::Mode mode) noexcept { return mode == hal::Mode::kTrack || mode == hal::Mode::kCoast; }

// The rates `ddq` of a plan's velocities `dq`, as far as a plan that keeps the limits has them. A plan uses
// 95 % of a velocity's limit: above that, no acceleration is anticipated.
model::VecN SoundRates(const config::ServoConfig& config, const model::VecN& dq,
                       const model::VecN& ddq) noexcept {
  constexpr double kShare = 0.97;
  model::VecN sound = ddq;
  for (int i = 0; i < dq.size(); ++i) {
    const double dq_max =
        config.guard.joint_velocity_fraction * config.arm.joints[static_cast<std::size_t>(i)].dq_max;
    const double ddq_max = trajectory::PaceOf(config, i).ddq_max;
    sound[i] = std::fabs(dq[i]) < kShare * dq_max ? std::clamp(ddq[i], -ddq_max, ddq_max) : 0.0;
  }
  return sound;
}

// True if a plan for the believed pose suits all of a flat target's poses that are left.
bool IsToldApart(const estimate::PoseHypotheses& hypotheses) noexcept {
  const auto& plate = hypotheses.plate;
  return std::all_of(
      plate.all.begin(), plate.all.begin() + plate.count, [&](const estimate::PlatePose& pose) {
        return &pose == &plate.best() || control::IsSamePlace(pose.X_BO_still, plate.best().X_BO_still);
      });
}

// The planner knows the gains that the servo began with. With others, the law goes on alone.
bool HasTunedGain(const TuningState& tuning) noexcept {
  constexpr std::array<std::size_t, 3> kGains{0, 1, 2};  // servo.lambda, lambda_near, lambda_slope
  return std::any_of(kGains.begin(), kGains.end(), [&](std::size_t key) { return tuning.ramps[key].asked; });
}

}  // namespace

// Takes a part of the plan that was asked for. All others are dropped: no plan changes under the arm. But the
// answer that came too late shows that the planner is there.
void ServoTask::TakePlan(const trajectory::PlanPart& part) noexcept {
  if (!part.IsThere()) {
    return;
  }
  if (state_.way.asked_ns >= 0 && part.head.stamp_ns == state_.way.asked_ns) {
    static_cast<void>(state_.plans.Take(part));
  } else if (part.head.stamp_ns == state_.way.late_ns) {
    state_.way.late_ns = -1;
  }
}

void ServoTask::ComputeVisualLaw(const trajectory::PlanPart& plan) noexcept {
  TakePlan(plan);
  state_.way.note.event = hal::PlanEvent::kNone;
  state_.on_horizon = false;
  state_.feature_valid = state_.prediction.known && ComputeFeature();
  if (!state_.feature_valid) {
    return;
  }
  control::ChooseInteraction(config_.law, goal_.L_s, state_.feature);
  const control::LawJoints joints{state_.J_C, state_.q, state_.reference.dq};
  control::CommandFeature(config_.law, state_.feature, joints, state_.law);
  // A person leads an arm that floats.
  const bool floats = state_.law_state.kind == config::MotionLawKind::kFloat;
  if (IsTracking(state_.mode.mode) && !floats && trajectory::HasGoalPosture(config_)) {
    ChooseTheWay();
  }
  if (IsPlanned()) {
    return;  // the joints' motion is known
  }
  config::LawConfig law = config_.law;
  if (control::KeepsPosture(state_.way, state_.prediction.p_BO)) {
    law.q_posture = model::ToArray(state_.way.q_end);
  }
  control::CommandJoints(law, config_.arm, state_.feature, joints, state_.law);
  SwingAboutADisc();
}

// Adds a swing to the law's wish while a disc's two poses are not told apart near the goal.
void ServoTask::SwingAboutADisc() noexcept {
  const auto& disc = state_.predict.hypotheses.disc;
  const bool steers = state_.mode.mode == hal::Mode::kTrack && state_.way.note.way == hal::Way::kLaw;
  if (!steers || disc.count == 0 || disc.stillness != estimate::Stillness::kUnknown) {
    return;
  }
  const control::SwungDisc swung{
      .radius = config_.feature.radius,
      .p_CO = state_.prediction.seen.X_CO.p,
      .p_CO_star = config_.feature.p_CO_C_star,
      .v_BO = state_.prediction.v_BO,
      .normal_C = state_.X_BC.R.transpose() * disc.best().normal_B,
      .J_C = state_.J_C,
      .limits = state_.limits & control::kBarriers,
  };
  if (control::IsWorthASwing(swung, state_.way.swing)) {
    control::AddSwing(swung, state_.way.swing, state_.law.task);
  }
}

// True if the joints follow a plan or a horizon.
bool ServoTask::IsPlanned() const noexcept {
  return state_.way.note.way == hal::Way::kPlan || state_.on_horizon;
}

void ServoTask::ChooseTheWay() noexcept {
  const auto& disc = state_.predict.hypotheses.disc;
  const control::WaySight sight{
      .X_BO = {state_.prediction.R_BO, state_.prediction.p_BO},
      .X_CO = state_.prediction.seen.X_CO,
      .v_BO = state_.prediction.v_BO,
      .w_BO = state_.prediction.seen.w_BO_C,
      .normal_B = disc.count > 0 ? disc.best().normal_B : model::Vec3(model::Vec3::Zero()),
      .reference = state_.reference,
      .limits = state_.limits,
      .now_ns = state_.now_ns,
      .is_told_apart = IsToldApart(state_.predict.hypotheses),
      .has_answer = state_.plans.IsWhole() && state_.plans.plan().stamp_ns == state_.way.asked_ns,
      .is_seen = state_.mode.mode == hal::Mode::kTrack,
      .is_eye_trusted = state_.eye.IsTrusted(),
      .is_eye_suspected = state_.eye.suspected,
  };
  const hal::Way before = state_.way.note.way;
  control::ChooseWay(config_, sight, state_.plans.plan(), state_.way);
  if (before == hal::Way::kPlan && state_.way.note.way != hal::Way::kPlan) {
    estimate::ForgetSteering(state_.eye);
  }
  if (state_.way.note.way == hal::Way::kPlan) {
    control::FollowPlan(config_, state_.plans.plan(), state_.reference, sight.is_seen, state_.way,
                        state_.plan_step);
  }
  state_.on_horizon = !HasTunedGain(state_.tuning) &&
                      control::FollowHorizon(config_, sight, state_.plans, state_.way, state_.plan_step);
}

// Target feature, plus orientation-hold rows if enabled.
bool ServoTask::ComputeFeature() noexcept {
  features::TargetInCamera seen = state_.prediction.seen;
  if (state_.way.turn != 0) {
    const int turns = features::TraitsOf(config_.feature.target).turns;
    seen.X_CO.R = seen.X_CO.R * features::EqualTurn(state_.way.turn, turns);
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
    ForgetMotion(state_);
    return;
  }
  if (state_.inputs.bad_ticks > 0) {
    return;  // no new state: the last command stays in force
  }
  if (!state_.holds) {
    if (state_.inputs.sound_ticks == 0) {
      return;
    }
    // The servo takes over the arm at its present state and velocity, and brings it to rest.
    state_.reference.q = state_.q;
    state_.reference.dq = state_.dq;
    state_.reference.ddq.setZero();
    state_.holds = true;
  }
  if (state_.mode.mode == hal::Mode::kMove) {
    state_.limits = moves::FollowMotion(config_, inputs.motion, state_.now_ns, state_.motion, state_.known,
                                        state_.reference);
    CheckFollowing();
    state_.motion.off += kOffShare * (state_.reference.q - state_.q - state_.motion.off);
    return;
  }
  const bool steering = IsTracking(state_.mode.mode) && state_.feature_valid;
  guard::MotionWish wish;
  const bool accelerates = control::LineOf(config_.law.law).commands_acceleration;
  const double slowing = accelerates ? 0.0 : control::SlowingPace(state_.way, state_.reference);
  if (!steering || (state_.way.note.way == hal::Way::kAwaitPlan && slowing == 0.0)) {
    wish = guard::StopTogether(config_, state_.reference);
  } else if (!ResolveWish(slowing, wish)) {
    LatchFault(hal::Fault::kNonFiniteControl, -1);
    return;
  }
  if (state_.mode.mode == hal::Mode::kBoot && !IsOutside()) {
    state_.limits |= hal::Bit(hal::Limit::kObstacle);  // the reason why Boot continues
  }
  state_.limits |=
      guard::GuardMotion(config_, wish, state_.poses.X_BE.p, state_.J_E_B, state_.known, state_.reference);
  CheckFollowing();
  UpdateBlockedTime();
  NoteSteering();
}

// The wish of the law, or of the plan, within the limits. `slowing`: the law's pace before a plan. False if
// it is not finite.
bool ServoTask::ResolveWish(double slowing, guard::MotionWish& wish) noexcept {
  const bool planned = state_.way.note.way == hal::Way::kPlan;
  const bool ahead = IsPlanned();
  const bool accelerates = control::LineOf(config_.law.law).commands_acceleration;
  double share = 1.0;  // of the joints' speed: a stop from less moves the target less in the picture
  if (!ahead && !accelerates) {
    share = slowing > 0.0 ? slowing : state_.way.pace;
    const std::int64_t since_ns = std::max(state_.track_since_ns, state_.way.since_ns);
    const double since_s =
        static_cast<double>(state_.now_ns - since_ns) / static_cast<double>(hal::kNsPerSecond);
    const double blend =
        slowing > 0.0 ? slowing : share * trajectory::SmoothStep(since_s / config_.law.smooth_start_s);
    state_.law.task.v *= blend;
    state_.law.task.dq_0 *= blend;
  }
  barriers::ViewedTarget target{config_.feature.Outline(), state_.prediction.seen, state_.J_C};
  const auto& disc = state_.predict.hypotheses.disc;
  if (disc.count > 0) {
    target.normal_C = state_.X_BC.R.transpose() * disc.best().normal_B;
  }
  control::ResolveMotion(config_, ahead ? state_.plan_step.task : state_.law.task,
                         {state_.reference, state_.poses, state_.J_E_B, state_.J_C, &target, planned, share},
                         state_.resolved);
  if (!state_.resolved.finite || !state_.resolved.dq.allFinite()) {
    return false;
  }
  wish = guard::MotionWish::Velocity(state_.resolved.dq);
  state_.limits = state_.resolved.limits;
  if (state_.limits == 0 && (ahead || accelerates)) {
    const model::VecN ddq =
        ahead ? state_.plan_step.ddq : model::VecN((wish.dq - state_.reference.dq) / hal::kTickPeriodS);
    wish.ddq = SoundRates(config_, wish.dq, ddq);
  }
  return true;
}

void ServoTask::CheckFollowing() noexcept {
  const int joint = guard::JointThatDoesNotFollow(config_.safety, state_.reference.q, state_.q);
  if (joint >= 0) {
    LatchFault(hal::Fault::kNotFollowing, joint);
  }
}

// Updates the time for which limits have blocked the arm from its goal. It does not run while a plan is
// awaited.
void ServoTask::UpdateBlockedTime() noexcept {
  const bool steering = IsTracking(state_.mode.mode) && state_.feature_valid;
  if (steering && state_.way.note.way == hal::Way::kAwaitPlan) {
    return;
  }
  bool blocked = false;
  if (steering && state_.way.note.way == hal::Way::kPlan) {
    blocked = control::IsHeldUp(state_.way);
  } else if (steering) {
    blocked = control::IsBlocked(config_.law, state_.feature, state_.law, state_.J_C, state_.reference.dq,
                                 state_.limits);
  }
  control::UpdateBlockedTime(blocked, state_.reach);
}

// Checks that the visual law brings the goal nearer. A joint motion may lead away from it at first.
void ServoTask::NoteSteering() noexcept {
  if (!IsTracking(state_.mode.mode) || !state_.feature_valid || state_.way.note.way != hal::Way::kLaw) {
    return;
  }
  const model::Vec6 V_BC_C = state_.J_C.lazyProduct(state_.reference.dq);
  const double share = state_.law.e.norm() / control::GoalSize(state_.feature);
  estimate::WatchSteering(config_.predict, share, V_BC_C.head<3>().norm(), state_.eye);
}

}  // namespace fovea::task
