// SPDX-License-Identifier: Apache-2.0
// The stages that decide where the arm moves: the visual law and the reference.
#include <algorithm>

#include "firmware/core/features/hold_orientation.hpp"
#include "firmware/core/guard/following.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/task/enter_mode.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::task {
namespace {

constexpr double kOffShare = hal::kTickPeriodS / 0.25;  // of a tick in the mean deviation from a motion

bool IsTracking(hal::Mode mode) noexcept { return mode == hal::Mode::kTrack || mode == hal::Mode::kCoast; }

}  // namespace

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
  sight.is_told_apart = !config_.feature.SeesOrientation() || state_.predict.hypotheses.plate.count == 1;
  control::ChooseWay(config_, sight, state_.way);
  if (state_.way.by_joints) {
    control::SteerByJoints(state_.way, state_.q, state_.prediction.seen, state_.J_C,
                           config_.feature.p_CO_C_star, state_.law.task);
  }
}

// Target feature, plus orientation-hold rows if enabled.
bool ServoTask::ComputeFeature() noexcept {
  features::TargetInCamera seen = state_.prediction.seen;
  if (state_.way.goal.turn != 0) {
    const int turns = features::TraitsOf(config_.feature.target).turns;
    seen.X_CO.R = seen.X_CO.R * control::EqualTurn(state_.way.goal.turn, turns);
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
    state_.limits =
        moves::FollowMotion(config_, inputs.motion, state_.now_ns, state_.motion, state_.reference);
    CheckFollowing();
    state_.motion.off += kOffShare * (state_.reference.q - state_.q - state_.motion.off);
    return;
  }
  guard::MotionWish wish;
  if (IsTracking(state_.mode.mode) && state_.feature_valid) {
    const std::int64_t since_ns = std::max(state_.track_since_ns, state_.way.since_ns);
    const double since_s =
        static_cast<double>(state_.now_ns - since_ns) / static_cast<double>(hal::kNsPerSecond);
    const double blend = trajectory::SmoothStep(since_s / config_.law.smooth_start_s);
    state_.law.task.v *= blend;
    state_.law.task.dq_0 *= blend;
    barriers::ViewedTarget target{config_.feature.Outline(), state_.prediction.seen, state_.J_C};
    const auto& disc = state_.predict.hypotheses.disc;
    if (disc.count > 0) {
      target.normal_C = state_.X_BC.R.transpose() * disc.best().normal_B;
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
    state_.limits |= hal::Bit(hal::Limit::kObstacle);  // the reason why Boot continues
  }
  state_.limits |=
      guard::GuardMotion(config_, wish, state_.poses.X_BE.p, state_.J_E_B, reference_poses, state_.reference);
  CheckFollowing();
  UpdateBlockedTime();
  NoteSteering();
}

void ServoTask::CheckFollowing() noexcept {
  const int joint = guard::JointThatDoesNotFollow(config_.safety, state_.reference.q, state_.q);
  if (joint >= 0) {
    LatchFault(hal::Fault::kNotFollowing, joint);
  }
}

// Updates the time for which limits have blocked the arm from its goal.
void ServoTask::UpdateBlockedTime() noexcept {
  const bool steering = IsTracking(state_.mode.mode) && state_.feature_valid;
  bool blocked = false;
  if (steering && state_.way.by_joints) {
    blocked = control::NoteHeld(state_.law.task, state_.reference.dq, state_.way);
  } else if (steering) {
    blocked = control::IsBlocked(config_.law, state_.feature, state_.law, state_.J_C, state_.reference.dq,
                                 state_.limits);
  }
  control::UpdateBlockedTime(blocked, state_.reach);
}

// Checks that the visual law brings the goal nearer. A joint motion may lead away from it at first.
void ServoTask::NoteSteering() noexcept {
  if (!IsTracking(state_.mode.mode) || !state_.feature_valid || state_.way.by_joints) {
    return;
  }
  const model::Vec6 V_BC_C = state_.J_C.lazyProduct(state_.reference.dq);
  estimate::WatchSteering(config_.predict, state_.law.e.norm() / state_.feature.s_star.norm(),
                          V_BC_C.head<3>().norm(), state_.eye);
}

}  // namespace fovea::task
