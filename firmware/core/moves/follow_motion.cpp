// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/moves/follow_motion.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/guard/stop_path.hpp"
#include "firmware/core/moves/pose_motion.hpp"

namespace fovea::moves {
namespace {

constexpr double kLateS = 1.0;            // a motion this late against its plan counts as blocked by a limit
constexpr double kRounding = 1.0 + 1e-9;  // a plan that uses all of a limit may round above it

bool Exceeds(double value, double limit) noexcept { return !(std::fabs(value) <= limit * kRounding); }

hal::LimitSet LimitsOfJoint(const config::ServoConfig& config, int i,
                            const trajectory::Reference& next) noexcept {
  const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
  const config::GuardConfig& guard = config.guard;
  hal::LimitSet limits = 0;
  if (Exceeds(next.dq[i], guard.joint_velocity_fraction * joint.dq_max)) {
    limits |= hal::Bit(hal::Limit::kJointVelocity);
  }
  if (Exceeds(next.ddq[i], guard.joint_acceleration_fraction * joint.ddq_max)) {
    limits |= hal::Bit(hal::Limit::kJointAcceleration);
  }
  if (next.q[i] > joint.q_max - guard.joint_position_margin ||
      next.q[i] < joint.q_min + guard.joint_position_margin) {
    limits |= hal::Bit(hal::Limit::kJointPosition);
  }
  return limits;
}

model::ArmPoses PosesOf(const config::ServoConfig& config, const model::VecN& q) noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses;
}

// Slows the reference down on its course as fast as allowed.
hal::LimitSet Brake(const config::ServoConfig& config, guard::KnownClearances& known,
                    trajectory::Reference& reference) noexcept {
  const model::ArmPoses poses = PosesOf(config, reference.q);
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
  return guard::GuardMotion(config, guard::StopTogether(config, reference), poses.X_BE.p, J_E_B, known,
                            reference);
}

// `next` becomes the reference if nothing forbids it.
hal::LimitSet TakeReference(const config::ServoConfig& config, const trajectory::Reference& next,
                            MotionState& state, guard::KnownClearances& known,
                            trajectory::Reference& reference) noexcept {
  hal::LimitSet limits = 0;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const double expected = reference.q[i] + reference.dq[i] * hal::kTickPeriodS;
    state.refused = state.refused || Exceeds(next.q[i] - expected, config.safety.setpoint_jump);
    limits |= LimitsOfJoint(config, i, next);
  }
  if (limits == 0 && !state.refused) {
    model::LazyPoses now(config.arm, reference.q);
    limits = guard::LimitsPassed(config, next, now, known);
  }
  state.refused = state.refused || limits != 0;
  if (state.refused) {
    return limits | Brake(config, known, reference);
  }
  reference = next;
  return 0;
}

hal::LimitSet TakeSetpoint(const config::ServoConfig& config, const MotionCommand& command,
                           MotionState& state, guard::KnownClearances& known,
                           trajectory::Reference& reference) noexcept {
  const int n = config.arm.num_joints;
  trajectory::Reference next;
  next.q = model::ToVector(command.q, n);
  next.dq = model::ToVector(command.dq, n);
  next.ddq = model::ToVector(command.ddq, n);
  if (!next.q.allFinite() || !next.dq.allFinite() || !next.ddq.allFinite()) {
    state.refused = true;
    return Brake(config, known, reference);
  }
  return TakeReference(config, next, state, known, reference);
}

// The share of the joints' `limits` that a move to `q_goal` may use so that the hand keeps its own limits.
// All joints arrive together, so that the path is nearly straight in joint space. Some of the hand's speed is
// left for a stop on the way, in which it may rise.
double ShareOfSpeed(const config::ServoConfig& config, const model::VecN& q, const model::VecN& q_goal,
                    const trajectory::JointMove::Limits& limits) noexcept {
  constexpr int kSamples = 12;
  constexpr double kShareOfSpeed = 0.85;  // of the limits of the hand's speed and of its turn
  constexpr double kShareOfTurn = 0.81;
  const model::VecN way = q_goal - q;
  double duration_s = 0.0;
  for (int i = 0; i < way.size(); ++i) {
    duration_s = std::max(duration_s, std::fabs(way[i]) / limits[static_cast<std::size_t>(i)].v_max);
  }
  if (!(duration_s > 0.0) || !std::isfinite(duration_s)) {
    return 1.0;
  }
  const model::VecN dq = way / duration_s;
  double share = 1.0;
  for (int k = 0; k <= kSamples; ++k) {
    const model::ArmPoses poses = PosesOf(config, q + way * (static_cast<double>(k) / kSamples));
    model::LinearJacobian J_E_B;
    model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
    const double speed = J_E_B.lazyProduct(dq).norm();
    const double turn = model::AngularVelocity(config.arm, poses, dq).norm();
    share =
        std::min({share, kShareOfSpeed * config::SpeedLimitOfReference(config.guard) / std::max(speed, 1e-9),
                  kShareOfTurn * config::TurnLimitOfReference(config.guard) / std::max(turn, 1e-9)});
  }
  return share;
}

bool PlanJoints(const config::ServoConfig& config, const MotionCommand& command,
                const trajectory::Reference& reference, MotionState& state) noexcept {
  trajectory::JointMove::Limits limits;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    limits[k] = {config.guard.joint_velocity_fraction * joint.dq_max,
                 config.guard.joint_acceleration_fraction * joint.ddq_max,
                 config.guard.joint_jerk_fraction * joint.dddq_max};
  }
  const model::VecN q_goal = model::ToVector(command.q, config.arm.num_joints);
  const double share = ShareOfSpeed(config, reference.q, q_goal, limits);
  for (trajectory::AxisLimits& limit : limits) {
    limit.v_max *= share;
  }
  return state.joints.Plan(reference, q_goal, limits);
}

MotionCommand HomeOf(const model::ArmModel& arm) noexcept {
  MotionCommand command;
  command.kind = MotionKind::kJointGoal;
  command.q = arm.q_ready;
  return command;
}

bool SameGoal(const MotionCommand& a, const MotionCommand& b) noexcept {
  return a.kind == b.kind && a.q == b.q && a.p_BE == b.p_BE && a.quaternion_BE == b.quaternion_BE;
}

// Plans for a goal unless it is already under way. False if it is invalid.
bool TakeGoal(const config::ServoConfig& config, const MotionCommand& command, std::int64_t now_ns,
              const trajectory::Reference& reference, MotionState& state) noexcept {
  if (SameGoal(command, state.goal)) {
    return true;
  }
  PoseSetpoint setpoint;
  bool planned = false;
  if (command.kind == MotionKind::kJointGoal) {
    planned = PlanJoints(config, command, reference, state);
  } else if (ToSetpoint(command, setpoint)) {
    state.X_BE = setpoint.X_BE;
    planned = PlanPose(config, state.X_BE, reference, state.pose);
  }
  if (planned) {
    state.goal = command;
    state.start_ns = now_ns;
  }
  return planned;
}

MotionCommand Resolved(const config::ServoConfig& config, const MotionCommand& asked) noexcept {
  return asked.kind == MotionKind::kHome ? HomeOf(config.arm) : asked;
}

void Arrive(MotionState& state) noexcept {
  state.done = state.goal;
  state.Stop();
}

}  // namespace

void NoteAsked(const config::ServoConfig& config, const MotionCommand& asked, MotionState& state) noexcept {
  if (state.HasArrived() && !SameGoal(Resolved(config, asked), state.done)) {
    state.done.kind = MotionKind::kNone;
  }
}

hal::LimitSet FollowMotion(const config::ServoConfig& config, const MotionCommand& asked, std::int64_t now_ns,
                           MotionState& state, guard::KnownClearances& known,
                           trajectory::Reference& reference) noexcept {
  const MotionCommand command = Resolved(config, asked);
  state.refused = false;
  switch (command.kind) {
    case MotionKind::kNone: break;
    case MotionKind::kJointSetpoint:
      state.Stop();
      return TakeSetpoint(config, command, state, known, reference);
    case MotionKind::kPoseSetpoint: {
      state.Stop();
      PoseSetpoint setpoint;
      state.refused = !ToSetpoint(command, setpoint);
      return FollowPose(config, setpoint, state.refused, state.resolved, known, reference);
    }
    case MotionKind::kHome:
    case MotionKind::kJointGoal:
    case MotionKind::kPoseGoal:
      if (!TakeGoal(config, command, now_ns, reference, state)) {
        state.Stop();
        state.refused = true;
        return Brake(config, known, reference);
      }
      break;
  }
  const double t = static_cast<double>(now_ns - state.start_ns) * 1e-9 + hal::kTickPeriodS;
  hal::LimitSet limits = 0;
  if (state.goal.kind == MotionKind::kJointGoal) {
    trajectory::Reference next;
    state.joints.At(t, next);
    limits = TakeReference(config, next, state, known, reference);
    if (t >= state.joints.Duration()) {
      Arrive(state);
    }
  } else if (state.goal.kind == MotionKind::kPoseGoal) {
    limits = FollowPose(config, PoseAt(state.X_BE, state.pose, t), state.refused, state.resolved, known,
                        reference);
    if (t >= state.pose.Duration() && StandsAt(config, state.X_BE, reference)) {
      Arrive(state);
    }
    state.refused = state.refused || t > state.pose.Duration() + kLateS;
  } else {
    return Brake(config, known, reference);
  }
  if (state.refused) {
    state.Stop();
  }
  return limits;
}

}  // namespace fovea::moves
