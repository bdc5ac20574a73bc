#include "fovea/servo/stop_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fovea/model/kinematics.hpp"
#include "fovea/servo/obstacle.hpp"
#include "fovea/servo/velocity_change.hpp"

namespace fovea::servo {
namespace {

constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
constexpr double kSlack = 1e-9;  // rounding is no step outward [m, rad]

// A joint that stops after `distance` from q_now, given that it may go up to `limit` (or no further than it
// already is).
bool Within(double q, double q_now, double low, double high) noexcept {
  return q <= std::max(high, q_now) + kSlack && q >= std::min(low, q_now) - kSlack;
}

struct StopPlan {
  std::array<VelocityChange, model::kMaxJoints> joints;
  double duration_s = 0.0;
};

StopPlan PlanAll(const ServoConfig& config, const Reference& reference) noexcept {
  StopPlan plan;
  for (int i = 0; i < reference.q.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    plan.joints[k] =
        PlanVelocityChange(reference.dq[i], reference.ddq[i], 0.0,
                           {joint.dq_max, config.guard.joint_acceleration_fraction * joint.ddq_max,
                            config.guard.joint_jerk_fraction * joint.dddq_max});
    plan.duration_s = std::max(plan.duration_s, plan.joints[k].Duration());
  }
  return plan;
}

using PerJoint = std::array<double, model::kMaxJoints>;

// How far the end effector goes at most per travel of each joint: its distance from the joint's axis, which
// the lengths of the links between them bound; 1 for a joint that slides.
PerJoint Levers(const model::ArmModel& arm) noexcept {
  PerJoint levers{};
  double length = arm.X_LnE.p.norm();  // of the links from here to the end effector
  for (int i = arm.num_joints - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    if (joint.type == model::JointType::kRevolute) {
      levers[k] = length;
    } else {
      levers[k] = 1.0;
      length += std::max(std::fabs(joint.q_min), std::fabs(joint.q_max));
    }
    length += joint.X_PJ.p.norm();
  }
  return levers;
}

// The stop, looked at from one point of time on.
class StopWay {
 public:
  StopWay(const ServoConfig& config, const Reference& reference) noexcept
      : config_(config),
        reference_(reference),
        plan_(PlanAll(config, reference)),
        levers_(Levers(config.arm)) {}

  // The ticks' own steps come on top of the continuous motion.
  [[nodiscard]] double Duration() const noexcept { return plan_.duration_s + kPeriodS; }

  // Where the joints are `t` seconds into the stop, and how fast the end effector can be from then on at
  // most.
  double At(double t, model::VecN& q) const noexcept {
    double fastest = 0.0;
    for (int i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const AxisState state = plan_.joints[k].At(t);
      q[i] = reference_.q[i] + reference_.dq[i] * kPeriodS + state.x;
      // A joint is never faster than now, or than when it has released its acceleration.
      const double settled = SettledVelocity(
          state.v, state.a, config_.guard.joint_jerk_fraction * config_.arm.joints[k].dddq_max);
      fastest += levers_[k] * std::max(std::fabs(state.v), std::fabs(settled));
    }
    return fastest;
  }

  // How far the end effector is at most from where it was with the joints at `q_now` when the stop begins.
  [[nodiscard]] double FirstStep(const model::VecN& q_now) const noexcept {
    double reach = 0.0;
    for (int i = 0; i < q_now.size(); ++i) {
      const double step = std::fabs(reference_.q[i] - q_now[i]) + std::fabs(reference_.dq[i]) * kPeriodS;
      reach += levers_[static_cast<std::size_t>(i)] * step;
    }
    return reach;
  }

 private:
  const ServoConfig& config_;
  const Reference& reference_;
  StopPlan plan_;
  PerJoint levers_;
};

// What bounds the end effector's point, each with its margin; what is already past one may only come back.
class Bounds {
 public:
  Bounds(const GuardConfig& guard, const model::Vec3& p_now) noexcept
      : obstacles_(guard.obstacles),
        num_obstacles_(CountObstacles(guard.obstacles)),
        radius_(std::max(guard.workspace_radius - guard.workspace_margin, p_now.norm()) + kSlack) {
    for (int i = 0; i < num_obstacles_; ++i) {
      const double clearance = ClearanceOf(obstacles_, i, p_now).distance;
      least_[static_cast<std::size_t>(i)] = std::min(guard.workspace_margin, clearance) - kSlack;
    }
  }

  // The distance to the nearest; below 0, and `passed` set, where it is passed.
  double Clear(const model::Vec3& p, hal::LimitSet& passed) const noexcept {
    double clear = radius_ - p.norm();
    if (!(clear >= 0.0)) {
      passed = hal::Bit(hal::Limit::kWorkspace);
      return clear;
    }
    for (int i = 0; i < num_obstacles_; ++i) {
      const double left = ClearanceOf(obstacles_, i, p).distance - least_[static_cast<std::size_t>(i)];
      if (!(left >= 0.0)) {
        passed = hal::Bit(hal::Limit::kObstacle);
        return left;
      }
      clear = std::min(clear, left);
    }
    return clear;
  }

 private:
  const Obstacles& obstacles_;
  int num_obstacles_;
  double radius_;
  std::array<double, 2 * Obstacles::kMost> least_{};  // clearance of each that must be kept
};

}  // namespace

hal::LimitSet LimitsPassed(const ServoConfig& config, const Reference& reference, const model::VecN& q_now,
                           const model::Vec3& p_now) noexcept {
  const GuardConfig& guard = config.guard;
  const StopWay way(config, reference);
  const double duration = way.Duration();
  model::VecN q = reference.q;

  // Joints: a joint is furthest out where it stops, unless it still turns round before.
  way.At(duration, q);
  for (int i = 0; i < q.size(); ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    if (!Within(q[i], q_now[i], joint.q_min + guard.joint_position_margin,
                joint.q_max - guard.joint_position_margin)) {
      return hal::Bit(hal::Limit::kJointPosition);
    }
  }

  // The end effector's point: at points of time that are denser at the start, which is what will be gone for
  // certain. None is looked at that the point cannot have reached a bound by.
  const Bounds bounds(guard, p_now);
  hal::LimitSet passed = 0;
  double fastest = way.At(0.0, q);
  double clear_until = (bounds.Clear(p_now, passed) - way.FirstStep(q_now)) / std::max(fastest, kSlack);
  model::ArmPoses poses;
  for (int sample = 0; sample < kStopSamples; ++sample) {
    const double share = static_cast<double>(sample) / (kStopSamples - 1);
    const double t = duration * share * share;
    if (t < clear_until) {
      continue;
    }
    fastest = way.At(t, q);
    model::ComputePoses(config.arm, q, poses);
    passed = 0;
    const double clear = bounds.Clear(poses.X_BE.p, passed);
    if (passed != 0) {
      return passed;
    }
    clear_until = t + clear / std::max(fastest, kSlack);
  }
  return 0;
}

}  // namespace fovea::servo
