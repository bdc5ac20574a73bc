// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/guard_motion.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/barriers/workspace_barrier.hpp"
#include "firmware/core/guard/approach_velocity.hpp"
#include "firmware/core/guard/stop_path.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "firmware/core/trajectory/velocity_step.hpp"

namespace fovea::guard {
namespace {

using hal::Bit;
using hal::Limit;
using hal::LimitSet;
using model::LinearJacobian;

// Shares of the hand's speed limits that a wish may use; the stop's proof allows more.
constexpr double kSpeedShare = 0.93;
constexpr double kTurnShare = 0.89;
constexpr double kSlow = 1e-3;  // a slower joint stops by itself [rad/s, m/s]

const model::Joint& JointOf(const config::ServoConfig& config, int i) noexcept {
  return config.arm.joints[static_cast<std::size_t>(i)];
}

// Joint velocity: scaled as a whole, which keeps the direction of the motion.
LimitSet LimitVelocity(const config::ServoConfig& config, model::VecN& dq) noexcept {
  double scale = 1.0;
  for (int i = 0; i < dq.size(); ++i) {
    const double limit = config.guard.joint_velocity_fraction * JointOf(config, i).dq_max;
    const double speed = std::fabs(dq[i]);
    if (speed * scale > limit) {
      scale = limit / speed;
    }
  }
  if (scale == 1.0) {
    return 0;
  }
  dq *= scale;
  return Bit(Limit::kJointVelocity);
}

// The hand's linear and angular speed, the same way.
LimitSet LimitSpeed(const config::ServoConfig& config, const LinearJacobian& J_E_B, model::LazyPoses& now,
                    model::VecN& dq) noexcept {
  LimitSet limits = 0;
  const double speed = J_E_B.lazyProduct(dq).norm();
  if (const double most = kSpeedShare * config::SpeedLimitOfReference(config.guard); speed > most) {
    dq *= most / speed;
    limits |= Bit(Limit::kCartesianSpeed);
  }
  const double most_turn = kTurnShare * config::TurnLimitOfReference(config.guard);
  if (dq.lpNorm<1>() <= most_turn) {
    return limits;  // the hand turns no faster than all joints together
  }
  if (const double turn = model::AngularVelocity(config.arm, now.Get(), dq).norm(); turn > most_turn) {
    dq *= most_turn / turn;
    limits |= Bit(Limit::kRotationSpeed);
  }
  return limits;
}

// Joint position: each joint on its own, because the others may still do the task. Both limits allow a joint
// to stand, so only the one ahead of it matters.
LimitSet LimitJointPosition(const config::ServoConfig& config, const model::VecN& q,
                            model::VecN& dq) noexcept {
  const config::GuardConfig& guard = config.guard;
  LimitSet limits = 0;
  for (int i = 0; i < dq.size(); ++i) {
    const model::Joint& joint = JointOf(config, i);
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    const double room = dq[i] > 0.0 ? joint.q_max - guard.joint_position_margin - q[i]
                                    : q[i] - joint.q_min - guard.joint_position_margin;
    const double most = barriers::BarrierSpeed(room, pace.deceleration, pace.reaction_s);
    if (std::fabs(dq[i]) > most) {
      dq[i] = std::copysign(most, dq[i]);
      limits |= Bit(Limit::kJointPosition);
    }
  }
  return limits;
}

// Workspace: removes the part of the motion that leads out of the sphere too fast.
LimitSet LimitWorkspace(const config::ServoConfig& config, const model::Vec3& p_BE,
                        const LinearJacobian& J_E_B, model::VecN& dq) noexcept {
  const double radius = p_BE.norm();
  const model::Vec3 outward = p_BE / radius;
  const model::Vec3 v_E = J_E_B.lazyProduct(dq);
  double v_out = v_E.dot(outward);
  const double v_t2 = (v_E - v_out * outward).squaredNorm();
  const barriers::Barrier edge = barriers::WorkspaceBarrier(config, p_BE, v_t2);
  if (edge.value == HUGE_VAL) {
    return 0;
  }
  LimitSet limits = 0;
  // A motion along the edge may use at most half of the deceleration.
  const double deceleration = config.guard.workspace_deceleration;
  const double v_t2_max = 0.5 * deceleration * radius;
  if (v_t2 > v_t2_max && edge.value - edge.margin < v_t2 / (2.0 * deceleration)) {
    const double scale = std::sqrt(v_t2_max / v_t2);
    dq *= scale;
    v_out *= scale;
    limits |= Bit(Limit::kWorkspace);
  }
  const double v_max = edge.SpeedMost();
  if (v_out > v_max) {
    // Smallest change of dq that brings the outward speed to v_max.
    const model::VecN gradient = barriers::WorkspaceGradient(J_E_B, outward);
    double a2 = 0.0;
    for (int i = 0; i < dq.size(); ++i) {
      a2 += gradient[i] * gradient[i];
    }
    if (a2 > 1e-9) {
      dq += gradient * ((v_out - v_max) / a2);
    }
    limits |= Bit(Limit::kWorkspace);
  }
  return limits;
}

}  // namespace

MotionWish StopTogether(const config::ServoConfig& config, const trajectory::Reference& reference) noexcept {
  MotionWish wish = MotionWish::Velocity(model::VecN::Zero(reference.dq.size()));
  double share = 0.0;  // of its velocity that the slowest joint to stop keeps after this tick
  for (int i = 0; i < reference.dq.size(); ++i) {
    if (std::fabs(reference.dq[i]) < kSlow) {
      continue;
    }
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    const trajectory::VelocityStep step =
        trajectory::StepVelocity({reference.q[i], reference.dq[i], reference.ddq[i]}, 0.0, 0.0,
                                 {0.0, pace.ddq_max, pace.dddq_max}, hal::kTickPeriodS);
    share = std::max(share, step.state.v / reference.dq[i]);
  }
  share = std::min(share, 1.0);
  for (int i = 0; i < reference.dq.size(); ++i) {
    if (std::fabs(reference.dq[i]) >= kSlow) {
      wish.dq[i] = share * reference.dq[i];
      wish.ddq[i] = (wish.dq[i] - reference.dq[i]) / hal::kTickPeriodS;
    }
  }
  wish.stops = true;
  return wish;
}

LimitSet GuardMotion(const config::ServoConfig& config, const MotionWish& wish, const model::Vec3& p_BE,
                     const LinearJacobian& J_E_B, KnownClearances& known,
                     trajectory::Reference& reference) noexcept {
  model::LazyPoses now(config.arm, reference.q);
  model::VecN dq = wish.dq;
  LimitSet limits = LimitVelocity(config, dq);
  limits |= LimitJointPosition(config, reference.q, dq);
  if (const LimitSet workspace = LimitWorkspace(config, p_BE, J_E_B, dq); workspace != 0) {
    // The workspace correction may move a joint again, so that the joint's limits apply once more.
    limits |= workspace | LimitJointPosition(config, reference.q, dq);
  }
  limits |= LimitVelocity(config, dq);
  limits |= LimitSpeed(config, J_E_B, now, dq);
  const model::VecN ddq = limits == 0 ? wish.ddq : model::VecN::Zero(dq.size());
  if (wish.stops && limits != 0) {
    dq.setZero();
  }

  // The largest share of the wish from which a stop is proved, found by halving; the last try is braking. The
  // whole wish is approached by all joints together, to keep its direction. Not where a barrier has bent it
  // or the hand is at its own speed limit: there each joint must follow as fast as it can. (A stop's wish has
  // all joints in step.)
  constexpr int kTries = 5;
  constexpr LimitSet kShapes = Bit(Limit::kJointPosition) | Bit(Limit::kWorkspace) |
                               Bit(Limit::kRotationSpeed) | Bit(Limit::kCartesianSpeed);
  bool together = (limits & kShapes) == 0 && !wish.stops;
  double share = 1.0;
  trajectory::Reference next;
  LimitSet acceleration_limits = 0;
  for (int i = 0; i < kTries; ++i) {
    next = reference;
    acceleration_limits = together ? ApproachTogether(config, dq, ddq, next)
                                   : ApproachAlone(config, share * dq, share * ddq, next);
    const LimitSet passed = share > 0.0 ? LimitsPassed(config, next, now, known) : 0;
    if (passed == 0) {
      break;
    }
    limits |= passed;
    share = i + 2 < kTries ? 0.5 * share : 0.0;
    together = false;
  }
  reference = next;
  return limits | acceleration_limits;
}

}  // namespace fovea::guard
