// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/stop_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

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

// The stop as a function of time.
class StopWay {
 public:
  // `levers` and `reference` must outlive the object.
  StopWay(const config::ServoConfig& config, const barriers::PerJoint& levers,
          const trajectory::Reference& reference) noexcept
      : config_(config), levers_(levers), reference_(reference) {
    for (int i = 0; i < reference.q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const model::Joint& joint = config.arm.joints[k];
      const trajectory::VelocityChange change = trajectory::PlanVelocityChange(
          reference.dq[i], reference.ddq[i], 0.0,
          {joint.dq_max, config.guard.joint_acceleration_fraction * joint.ddq_max, JerkOf(k)});
      paths_[k] = trajectory::VelocityPath(change);
      durations_s_[k] = change.Duration();
      duration_s_ = std::max(duration_s_, durations_s_[k]);
    }
  }

  // The tick's own step precedes the continuous motion.
  [[nodiscard]] double Duration() const noexcept { return duration_s_ + hal::kTickPeriodS; }

  // Upper bounds: speed of any point of the arm [m/s], angular speed of its hand [rad/s].
  struct Most {
    double speed = kSlack;
    double turn = 0.0;
  };

  // The joints' positions, velocities and accelerations `t` seconds into the stop. Returns the bounds at that
  // time.
  Most At(double t, trajectory::Reference& joints) const noexcept {
    Most most;
    for (int i = 0; i < joints.q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const trajectory::AxisState state = paths_[k].At(t);
      joints.q[i] = Start(i) + state.x;
      joints.dq[i] = state.v;
      joints.ddq[i] = state.a;
      Add(k, std::fabs(state.v), most);
    }
    return most;
  }

  // The bounds from the time on at which the joints are so.
  [[nodiscard]] Most From(const trajectory::Reference& joints) const noexcept {
    Most most;
    for (int i = 0; i < joints.q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      Add(k, SpeedMost(k, joints.dq[i], joints.ddq[i]), most);
    }
    return most;
  }

  // The joints' positions at the end of the stop.
  void End(model::VecN& q) const noexcept {
    for (int i = 0; i < q.size(); ++i) {
      q[i] = Start(i) + paths_[static_cast<std::size_t>(i)].End().x;
    }
  }

  // An upper bound of every point's distance between its place at the posture `q` and its places during the
  // stop, which ends at `q_end`. A joint that does not reverse is furthest away where the stop begins or
  // ends.
  [[nodiscard]] double FurthestFrom(const model::VecN& q, const model::VecN& q_end) const noexcept {
    double distance = kRounding;
    for (int i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double v = reference_.dq[i];
      const double settled = trajectory::SettledVelocity(v, reference_.ddq[i], JerkOf(k));
      const double begins = std::fabs(Start(i) - q[i]);
      const double far = v * settled >= 0.0
                             ? std::max(begins, std::fabs(q_end[i] - q[i]))
                             : begins + durations_s_[k] * std::max(std::fabs(v), std::fabs(settled));
      distance += levers_[k] * far;
    }
    return distance;
  }

 private:
  static constexpr double kRounding = 1e-12;  // of a distance [m]

  [[nodiscard]] double JerkOf(std::size_t k) const noexcept {
    return config_.guard.joint_jerk_fraction * config_.arm.joints[k].dddq_max;
  }
  // Where the continuous motion of joint `i` begins.
  [[nodiscard]] double Start(int i) const noexcept {
    return reference_.q[i] + reference_.dq[i] * hal::kTickPeriodS;
  }
  void Add(std::size_t k, double speed, Most& most) const noexcept {
    most.speed += levers_[k] * speed;
    most.turn += config_.arm.joints[k].type == model::JointType::kRevolute ? speed : 0.0;
  }
  // A joint is never faster than now, or than after it has released its acceleration.
  [[nodiscard]] double SpeedMost(std::size_t k, double v, double a) const noexcept {
    return std::max(std::fabs(v), std::fabs(trajectory::SettledVelocity(v, a, JerkOf(k))));
  }

  const config::ServoConfig& config_;
  const barriers::PerJoint& levers_;
  const trajectory::Reference& reference_;
  std::array<trajectory::VelocityPath, model::kMaxJoints> paths_;
  std::array<double, model::kMaxJoints> durations_s_{};
  double duration_s_ = 0.0;
};

// Upper bounds of the hand's speeds at postures not far from `q_now`, without their poses.
//
// The hand's velocity is sum_i J_i(q) dq_i. The joints beyond joint i move the hand, by at most b_i; those up
// to joint i turn J_i, by at most t_i. So J_i changes by at most b_i + (|J_i| + b_i) t_i. From the hand
// inwards, b grows by d_i (|J_i| + b_i) for a joint that turns by d_i, because the hand is no further than
// that from its axis. A joint nearer to the base than i also turns i's axis.
class HandSpeeds {
 public:
  // `q_now` and `poses_now` must outlive the object.
  HandSpeeds(const model::ArmModel& arm, const model::VecN& q_now, const model::ArmPoses& poses_now) noexcept
      : arm_(arm), q_now_(q_now), poses_now_(poses_now) {
    model::ComputeLinearJacobian(arm, poses_now, poses_now.X_BE.p, J_);
    for (int i = 0; i < q_now.size(); ++i) {
      lengths_[static_cast<std::size_t>(i)] = J_.col(i).norm();
    }
  }

  // Of its linear velocity [m/s].
  [[nodiscard]] double Speed(const model::VecN& q, const model::VecN& dq) const noexcept {
    double turned = 0.0;  // by the joints up to joint i [rad]
    for (int i = 0; i < q.size(); ++i) {
      turned += std::fabs(q[i] - q_now_[i]);
    }
    double beyond = 0.0;  // what the joints beyond joint i have moved the hand by [m]
    double more = 0.0;    // than with J at `q_now`
    model::Vec3 v = model::Vec3::Zero();
    for (int i = static_cast<int>(q.size()) - 1; i >= 0; --i) {
      const double moved = std::fabs(q[i] - q_now_[i]);
      const double far = lengths_[static_cast<std::size_t>(i)] + beyond;
      more += std::fabs(dq[i]) * (beyond + far * turned);
      v += dq[i] * J_.col(i);
      turned -= moved;
      beyond += far * moved;
    }
    return v.norm() + more + kSlack;
  }

  // Of its angular velocity [rad/s].
  [[nodiscard]] double Turn(const model::VecN& q, const model::VecN& dq) const noexcept {
    double turned = 0.0;
    double more = 0.0;
    for (int i = 0; i < q.size(); ++i) {
      more += std::fabs(dq[i]) * turned;
      turned += std::fabs(q[i] - q_now_[i]);
    }
    return model::AngularVelocity(arm_, poses_now_, dq).norm() + more + kSlack;
  }

 private:
  const model::ArmModel& arm_;
  const model::VecN& q_now_;
  const model::ArmPoses& poses_now_;
  model::LinearJacobian J_;
  hal::JointArray lengths_{};  // of J's columns [m]; of a sliding joint 1
};

// The arm's barriers, each with its margin. Past a barrier the arm may only come back.
//
// They are looked at only where no known posture is near enough (known_clearances.hpp). That holds for a pair
// of links too: seen from the one nearer to the base, only the joints between them move the other.
class Bounds {
 public:
  // `now` and `known` must outlive the object.
  Bounds(const config::ServoConfig& config, model::LazyPoses& now, KnownClearances& known) noexcept
      : arm_(config.arm), solid_(config), now_(now), known_(known) {}

  // Looks at all of them with the joints at `q` and the links at `poses`. The limits of the first exceeded
  // one; 0 if there is none.
  [[nodiscard]] hal::LimitSet Look(const model::VecN& q, const model::ArmPoses& poses) noexcept {
    const barriers::ArmBodies bodies = barriers::PlaceBodies(arm_, poses);
    double clearance = HUGE_VAL;
    for (int i = 0; i < solid_.size(); ++i) {
      const double value = solid_.ValueOf(i, poses, bodies);
      const double room = value - solid_.StopMarginOf(i);
      if (!(room >= -kSlack) && !(value >= ValueNow(i) - kSlack)) {
        return hal::Bit(solid_.NameOf(i));
      }
      clearance = std::min(clearance, room);
    }
    if (clearance > 0.0) {  // else it would only take the place of a posture that is of use
      known_.Add(q, clearance);
    }
    return 0;
  }

 private:
  [[nodiscard]] double ValueNow(int i) noexcept {
    const model::ArmPoses& poses = now_.Get();
    if (!bodies_now_) {
      bodies_now_ = barriers::PlaceBodies(arm_, poses);
    }
    return solid_.ValueOf(i, poses, *bodies_now_);
  }

  const model::ArmModel& arm_;
  barriers::SolidBarriers solid_;
  model::LazyPoses& now_;
  std::optional<barriers::ArmBodies> bodies_now_;
  KnownClearances& known_;
};

}  // namespace

hal::LimitSet LimitsPassed(const config::ServoConfig& config, const trajectory::Reference& reference,
                           model::LazyPoses& now, KnownClearances& known) noexcept {
  const config::GuardConfig& guard = config.guard;
  const barriers::PerJoint& levers = known.LeversOf(config);
  const StopWay way(config, levers, reference);
  const double duration = way.Duration();
  const model::VecN& q_now = now.q();
  model::VecN q_end = reference.q;

  // Joints: a joint is furthest out where it stops, unless it reverses before.
  way.End(q_end);
  for (int i = 0; i < q_end.size(); ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    if (!Within(q_end[i], q_now[i], joint.q_min + guard.joint_position_margin,
                joint.q_max - guard.joint_position_margin)) {
      return hal::Bit(hal::Limit::kJointPosition);
    }
  }

  // Arm and hand. The bounds are looked at only where no known posture is near enough, and the hand's speeds
  // only while they could exceed their limits.
  const auto is_clear = [&] {
    const KnownClearances::Posture& nearby = known.last();
    return nearby.clearance > 0.0 && way.FurthestFrom(nearby.q, q_end) <= nearby.clearance;
  };
  bool are_clear = is_clear() || way.FurthestFrom(q_now, q_end) < kSlack;  // or the arm rests
  const double speed_most = config::kSpeedShareMost * config::SpeedLimitOfReference(guard);
  const double turn_most = config::kTurnShareMost * config::TurnLimitOfReference(guard);
  const auto is_slow = [&](const StopWay::Most& most) {
    return most.speed <= speed_most && most.turn <= turn_most;
  };
  if (are_clear && is_slow(way.From(reference))) {
    return 0;
  }
  // At times that are denser at the start, because the arm certainly moves along that part.
  Bounds bounds(config, now, known);
  std::optional<HandSpeeds> hand;
  std::optional<model::ArmPoses> poses;
  trajectory::Reference joints = reference;
  for (int sample = 0; sample < kStopSamples; ++sample) {
    const double share = static_cast<double>(sample) / (kStopSamples - 1);
    const StopWay::Most most = way.At(duration * share * share, joints);
    if (are_clear && is_slow(most) && is_slow(way.From(joints))) {
      return 0;
    }
    if (!is_slow(most) && !hand) {
      hand.emplace(config.arm, q_now, now.Get());
    }
    const bool checks_speed = most.speed > speed_most && !(hand->Speed(joints.q, joints.dq) <= speed_most);
    const bool checks_turn = most.turn > turn_most && !(hand->Turn(joints.q, joints.dq) <= turn_most);
    const bool checks_bounds = !are_clear && !known.Cover(joints.q);
    if (checks_speed || checks_turn || checks_bounds) {
      model::ComputePoses(config.arm, joints.q, poses ? *poses : poses.emplace());
    }
    if (checks_speed &&
        model::LinearVelocity(config.arm, *poses, poses->X_BE.p, joints.dq).norm() > speed_most) {
      return hal::Bit(hal::Limit::kCartesianSpeed);
    }
    if (checks_turn && model::AngularVelocity(config.arm, *poses, joints.dq).norm() > turn_most) {
      return hal::Bit(hal::Limit::kRotationSpeed);
    }
    if (checks_bounds) {
      if (const hal::LimitSet passed = bounds.Look(joints.q, *poses); passed != 0) {
        return passed;
      }
    }
    // A posture that covers the first place often covers all of a slow stop.
    are_clear = are_clear || (sample == 0 && is_clear());
  }
  return 0;
}

}  // namespace fovea::guard
