#include "fovea/servo/guard_motion.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/servo/stop_path.hpp"

namespace fovea::servo {
namespace {

using hal::Bit;
using hal::Limit;
using hal::LimitSet;
using model::LinearJacobian;

constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;

// The time lost between the wish to brake and full deceleration: one tick, and the ramp of the jerk limit.
double ReactionTime(double deceleration, double jerk) noexcept {
  return 2.0 * kPeriodS + deceleration / jerk;
}

const model::Joint& JointOf(const ServoConfig& config, int i) noexcept {
  return config.arm.joints[static_cast<std::size_t>(i)];
}

// Joint velocity: scaled as a whole, so that the direction of the motion stays.
LimitSet LimitVelocity(const ServoConfig& config, model::VecN& dq) noexcept {
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

// Cartesian speed, the same way.
LimitSet LimitSpeed(const ServoConfig& config, const LinearJacobian& J_E_B, model::VecN& dq) noexcept {
  const double speed = J_E_B.lazyProduct(dq).norm();
  if (speed <= config.guard.cartesian_speed) {
    return 0;
  }
  dq *= config.guard.cartesian_speed / speed;
  return Bit(Limit::kCartesianSpeed);
}

// Joint position: each joint on its own, since the others may still carry the task.
LimitSet LimitJointPosition(const ServoConfig& config, const model::VecN& q, model::VecN& dq) noexcept {
  const GuardConfig& guard = config.guard;
  LimitSet limits = 0;
  for (int i = 0; i < dq.size(); ++i) {
    const model::Joint& joint = JointOf(config, i);
    const double deceleration = guard.braking_fraction * guard.joint_acceleration_fraction * joint.ddq_max;
    const double reaction = ReactionTime(deceleration, guard.joint_jerk_fraction * joint.dddq_max);
    const double up = BarrierSpeed(joint.q_max - guard.joint_position_margin - q[i], deceleration, reaction);
    const double down =
        BarrierSpeed(q[i] - joint.q_min - guard.joint_position_margin, deceleration, reaction);
    if (dq[i] > up) {
      dq[i] = up;
      limits |= Bit(Limit::kJointPosition);
    } else if (dq[i] < -down) {
      dq[i] = -down;
      limits |= Bit(Limit::kJointPosition);
    }
  }
  return limits;
}

// Workspace: the part of the motion that leads out of the sphere too fast is taken away.
LimitSet LimitWorkspace(const ServoConfig& config, const model::Vec3& p_BE, const LinearJacobian& J_E_B,
                        model::VecN& dq) noexcept {
  const GuardConfig& guard = config.guard;
  const double radius = p_BE.norm();
  if (radius < 1e-6) {
    return 0;  // at the centre every direction leads out, and none is near the boundary
  }
  LimitSet limits = 0;
  const model::Vec3 outward = p_BE / radius;
  const model::Vec3 v_E = J_E_B.lazyProduct(dq);
  double v_out = v_E.dot(outward);
  // Along the boundary the centripetal share v_t^2 / r of the deceleration is spent; at most half of it may
  // be, so the rest still stops the outward motion.
  const double v_t2 = (v_E - v_out * outward).squaredNorm();
  const double v_t2_max = 0.5 * guard.workspace_deceleration * radius;
  const double distance = guard.workspace_radius - guard.workspace_margin - radius;
  double spent = v_t2;
  if (v_t2 > v_t2_max && distance < v_t2 / (2.0 * guard.workspace_deceleration)) {
    const double scale = std::sqrt(v_t2_max / v_t2);
    dq *= scale;
    v_out *= scale;
    spent = v_t2_max;
    limits |= Bit(Limit::kWorkspace);
  }
  const double deceleration =
      std::max(guard.workspace_deceleration - spent / radius, 0.5 * guard.workspace_deceleration);
  const double v_max = BarrierSpeed(distance, deceleration, SlowestReaction(config));
  if (v_out > v_max) {
    // Smallest change of dq that brings the outward speed to v_max.
    model::VecN a = model::VecN::Zero(dq.size());
    double a2 = 0.0;
    for (int i = 0; i < dq.size(); ++i) {
      a[i] = J_E_B.col(i).dot(outward);
      a2 += a[i] * a[i];
    }
    if (a2 > 1e-9) {
      dq -= a * ((v_out - v_max) / a2);
    }
    limits |= Bit(Limit::kWorkspace);
  }
  return limits;
}

// Acceleration and jerk: the reference approaches the wished velocity without overshoot, also when that goes
// on changing by `ddq_des`.
LimitSet LimitAcceleration(const ServoConfig& config, const model::VecN& dq_des, const model::VecN& ddq_des,
                           Reference& reference) noexcept {
  const GuardConfig& guard = config.guard;
  LimitSet limits = 0;
  for (int i = 0; i < dq_des.size(); ++i) {
    const model::Joint& joint = JointOf(config, i);
    const double a_max = guard.joint_acceleration_fraction * joint.ddq_max;
    const double jerk_step = guard.joint_jerk_fraction * joint.dddq_max * kPeriodS;
    const double dv = dq_des[i] - reference.dq[i];
    const double wanted = dv / kPeriodS - ddq_des[i];
    // The acceleration from which it can still return to zero, by the jerk limit, within dv.
    const double half = 0.5 * jerk_step;
    const double a_stop = std::sqrt(half * half + 2.0 * jerk_step * std::fabs(wanted)) - half;
    double a = wanted;
    if (std::fabs(a) > a_stop) {
      a = std::copysign(a_stop, a);
    }
    a += ddq_des[i];
    if (std::fabs(a) > a_max) {
      a = std::copysign(a_max, a);
      limits |= Bit(Limit::kJointAcceleration);
    }
    const double change = a - reference.ddq[i];
    if (std::fabs(change) > jerk_step) {
      a = reference.ddq[i] + std::copysign(jerk_step, change);
      limits |= Bit(Limit::kJointJerk);
    }
    reference.ddq[i] = a;
    reference.dq[i] += a * kPeriodS;
    reference.q[i] += reference.dq[i] * kPeriodS;
  }
  return limits;
}

}  // namespace

// The largest of these over the joints: the arm as a whole brakes no sooner.
double SlowestReaction(const ServoConfig& config) noexcept {
  const GuardConfig& guard = config.guard;
  double slowest = 0.0;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const model::Joint& joint = JointOf(config, i);
    slowest = std::max(
        slowest, ReactionTime(guard.braking_fraction * guard.joint_acceleration_fraction * joint.ddq_max,
                              guard.joint_jerk_fraction * joint.dddq_max));
  }
  return slowest;
}

double BarrierSpeed(double distance, double deceleration, double reaction_s) noexcept {
  if (!(distance > 0.0)) {
    return 0.0;
  }
  return deceleration * (std::sqrt(reaction_s * reaction_s + 2.0 * distance / deceleration) - reaction_s);
}

LimitSet GuardMotion(const ServoConfig& config, const MotionWish& wish, const model::Vec3& p_BE,
                     const LinearJacobian& J_E_B, Reference& reference) noexcept {
  model::VecN dq = wish.dq;
  LimitSet limits = LimitVelocity(config, dq);
  limits |= LimitJointPosition(config, reference.q, dq);
  limits |= LimitWorkspace(config, p_BE, J_E_B, dq);
  // The correction for the workspace may have set a joint on the move again: what it may not do is cut.
  limits |= LimitJointPosition(config, reference.q, dq);
  limits |= LimitVelocity(config, dq);
  limits |= LimitSpeed(config, J_E_B, dq);
  const model::VecN ddq = limits == 0 ? wish.ddq : model::VecN::Zero(dq.size());

  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  // The largest share of the wish from which a stop is proved, found by halving; the last try is braking.
  constexpr int kTries = 5;
  double share = 1.0;
  Reference next;
  LimitSet acceleration_limits = 0;
  for (int i = 0; i < kTries; ++i) {
    next = reference;
    acceleration_limits = LimitAcceleration(config, share * dq, share * ddq, next);
    const LimitSet passed = share > 0.0 ? LimitsPassed(config, next, reference.q, poses.X_BE.p) : 0;
    if (passed == 0) {
      break;
    }
    limits |= passed;
    share = i + 2 < kTries ? 0.5 * share : 0.0;
  }
  reference = next;
  return limits | acceleration_limits;
}

}  // namespace fovea::servo
