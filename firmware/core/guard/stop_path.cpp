// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/stop_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/barriers/levers.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/velocity_change.hpp"

namespace fovea::guard {
namespace {

constexpr double kSlack = 1e-9;  // tolerance for rounding [m, rad]

// True if `q` is from `low` to `high`, or at least no further out than `q_now`.
bool Within(double q, double q_now, double low, double high) noexcept {
  return q <= std::max(high, q_now) + kSlack && q >= std::min(low, q_now) - kSlack;
}

struct StopPlan {
  std::array<trajectory::VelocityChange, model::kMaxJoints> joints;
  double duration_s = 0.0;
};

StopPlan PlanAll(const config::ServoConfig& config, const trajectory::Reference& reference) noexcept {
  StopPlan plan;
  for (int i = 0; i < reference.q.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    plan.joints[k] = trajectory::PlanVelocityChange(
        reference.dq[i], reference.ddq[i], 0.0,
        {joint.dq_max, config.guard.joint_acceleration_fraction * joint.ddq_max,
         config.guard.joint_jerk_fraction * joint.dddq_max});
    plan.duration_s = std::max(plan.duration_s, plan.joints[k].Duration());
  }
  return plan;
}

// The stop as a function of time.
class StopWay {
 public:
  StopWay(const config::ServoConfig& config, const trajectory::Reference& reference) noexcept
      : config_(config),
        reference_(reference),
        plan_(PlanAll(config, reference)),
        levers_(barriers::Levers(config.arm, config.guard.hand)) {}

  // The tick's own step precedes the continuous motion.
  [[nodiscard]] double Duration() const noexcept { return plan_.duration_s + hal::kTickPeriodS; }

  // Upper bounds from some time on: speed of any point of the arm [m/s], angular speed of its hand [rad/s].
  struct Most {
    double speed = 0.0;
    double turn = 0.0;
  };

  // The joints' positions and velocities `t` seconds into the stop. Returns the bounds from then on.
  Most At(double t, model::VecN& q, model::VecN& dq) const noexcept {
    Most most;
    for (int i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const trajectory::AxisState state = plan_.joints[k].At(t);
      q[i] = reference_.q[i] + reference_.dq[i] * hal::kTickPeriodS + state.x;
      dq[i] = state.v;
      // A joint is never faster than now, or than after it has released its acceleration.
      const double settled = trajectory::SettledVelocity(
          state.v, state.a, config_.guard.joint_jerk_fraction * config_.arm.joints[k].dddq_max);
      const double speed = std::max(std::fabs(state.v), std::fabs(settled));
      most.speed += levers_[k] * speed;
      most.turn += config_.arm.joints[k].type == model::JointType::kRevolute ? speed : 0.0;
    }
    most.speed = std::max(most.speed, kSlack);
    return most;
  }

  // The largest distance of a point of the arm, when the stop begins, from its place at `q_now`.
  [[nodiscard]] double FirstStep(const model::VecN& q_now) const noexcept {
    double reach = 0.0;
    for (int i = 0; i < q_now.size(); ++i) {
      const double step =
          std::fabs(reference_.q[i] - q_now[i]) + std::fabs(reference_.dq[i]) * hal::kTickPeriodS;
      reach += levers_[static_cast<std::size_t>(i)] * step;
    }
    return reach;
  }

 private:
  const config::ServoConfig& config_;
  const trajectory::Reference& reference_;
  StopPlan plan_;
  barriers::PerJoint levers_;
};

// The arm's barriers, each with its margin. Past a barrier the arm may only come back.
class Bounds {
 public:
  static constexpr int kMost = barriers::SolidBarriers::kMost;

  Bounds(const config::ServoConfig& config, const model::ArmPoses& now) noexcept : solid_(config) {
    const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, now);
    for (int i = 0; i < solid_.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double value = solid_.ValueOf(i, now, bodies);
      least_[k] = std::min(solid_.StopMarginOf(i), value) - kSlack;
      clear_now_[k] = solid_.ShareOf(i) * (value - least_[k]);
    }
  }

  [[nodiscard]] int size() const noexcept { return solid_.size(); }
  [[nodiscard]] hal::LimitSet LimitOf(int i) const noexcept { return hal::Bit(solid_.NameOf(i)); }
  // The distance that any point may still travel before bound `i`, at the posture `now`.
  [[nodiscard]] double ClearNow(int i) const noexcept { return clear_now_[static_cast<std::size_t>(i)]; }
  // The same with the links at `poses`; negative if the bound is exceeded.
  [[nodiscard]] double Clear(int i, const model::ArmPoses& poses,
                             const barriers::ArmBodies& bodies) const noexcept {
    return solid_.ShareOf(i) * (solid_.ValueOf(i, poses, bodies) - least_[static_cast<std::size_t>(i)]);
  }

 private:
  barriers::SolidBarriers solid_;
  std::array<double, kMost> least_{};  // smallest allowed value of each
  std::array<double, kMost> clear_now_{};
};

double HandSpeed(const model::ArmModel& arm, const model::ArmPoses& poses, const model::VecN& dq) noexcept {
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, poses.X_BE.p, J);
  return J.lazyProduct(dq).norm();
}

}  // namespace

hal::LimitSet LimitsPassed(const config::ServoConfig& config, const trajectory::Reference& reference,
                           const model::VecN& q_now, const model::ArmPoses& poses_now) noexcept {
  const config::GuardConfig& guard = config.guard;
  const StopWay way(config, reference);
  const double duration = way.Duration();
  model::VecN q = reference.q;
  model::VecN dq = reference.dq;

  // Joints: a joint is furthest out where it stops, unless it reverses before.
  way.At(duration, q, dq);
  for (int i = 0; i < q.size(); ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    if (!Within(q[i], q_now[i], joint.q_min + guard.joint_position_margin,
                joint.q_max - guard.joint_position_margin)) {
      return hal::Bit(hal::Limit::kJointPosition);
    }
  }

  // Arm and hand: at times that are denser at the start, because the arm certainly moves along that part. A
  // bound is checked only from the time at which some point can have reached it.
  const Bounds bounds(config, poses_now);
  std::array<double, Bounds::kMost> clear_until{};
  const StopWay::Most most_now = way.At(0.0, q, dq);
  const double first_step = way.FirstStep(q_now);
  const double speed_most = config::kSpeedShareMost * config::SpeedLimitOfReference(guard);
  const double turn_most = config::kTurnShareMost * config::TurnLimitOfReference(guard);
  // While the hand could exceed its speed or turn limit, each sample is checked.
  double first_due = most_now.speed > speed_most || most_now.turn > turn_most ? 0.0 : HUGE_VAL;
  for (int i = 0; i < bounds.size(); ++i) {
    double& until = clear_until[static_cast<std::size_t>(i)];
    until = (bounds.ClearNow(i) - first_step) / most_now.speed;
    first_due = std::min(first_due, until);
  }
  model::ArmPoses poses;
  for (int sample = 0; sample < kStopSamples; ++sample) {
    const double share = static_cast<double>(sample) / (kStopSamples - 1);
    const double t = duration * share * share;
    if (t < first_due) {
      continue;
    }
    const StopWay::Most most = way.At(t, q, dq);
    model::ComputePoses(config.arm, q, poses);
    const bool may_be_fast = most.speed > speed_most;
    if (may_be_fast && HandSpeed(config.arm, poses, dq) > speed_most) {
      return hal::Bit(hal::Limit::kCartesianSpeed);
    }
    const bool may_turn_fast = most.turn > turn_most;
    if (may_turn_fast && model::AngularVelocity(config.arm, poses, dq).norm() > turn_most) {
      return hal::Bit(hal::Limit::kRotationSpeed);
    }
    const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, poses);
    first_due = may_be_fast || may_turn_fast ? t : HUGE_VAL;
    for (int i = 0; i < bounds.size(); ++i) {
      double& until = clear_until[static_cast<std::size_t>(i)];
      if (!(t < until)) {
        const double clear = bounds.Clear(i, poses, bodies);
        if (!(clear >= 0.0)) {
          return bounds.LimitOf(i);
        }
        until = t + clear / most.speed;
      }
      first_due = std::min(first_due, until);
    }
  }
  return 0;
}

}  // namespace fovea::guard
