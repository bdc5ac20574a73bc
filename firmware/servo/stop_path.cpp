#include "fovea/servo/stop_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fovea/model/kinematics.hpp"
#include "fovea/servo/obstacle.hpp"

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
  std::array<JointStop, model::kMaxJoints> joints;
  double duration_s = 0.0;
};

StopPlan PlanAll(const ServoConfig& config, const Reference& reference) noexcept {
  StopPlan plan;
  for (int i = 0; i < reference.q.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    plan.joints[k] =
        PlanStop(reference.dq[i], reference.ddq[i], config.guard.joint_acceleration_fraction * joint.ddq_max,
                 config.guard.joint_jerk_fraction * joint.dddq_max);
    plan.duration_s = std::max(plan.duration_s, plan.joints[k].Duration());
  }
  return plan;
}

}  // namespace

JointStop PlanStop(double dq, double ddq, double ddq_max, double dddq_max) noexcept {
  // Mirrored so that it must brake: releasing the acceleration alone would leave it going forward.
  const double left = dq + ddq * std::fabs(ddq) / (2.0 * dddq_max);
  JointStop stop;
  stop.sign = left < 0.0 ? -1.0 : 1.0;
  stop.jerk = dddq_max;
  const double v = stop.sign * dq;
  const double a = stop.sign * ddq;
  // Velocity taken away: (2 a_peak^2 - a^2) / (2 jerk) + a_peak hold = v.
  const double peak2 = std::max(v * dddq_max + 0.5 * a * a, 0.0);
  stop.a_peak = std::sqrt(peak2);
  if (stop.a_peak > ddq_max) {
    stop.a_peak = ddq_max;
    stop.hold_s = (v + (a * a - 2.0 * ddq_max * ddq_max) / (2.0 * dddq_max)) / ddq_max;
  }
  stop.ramp_s = std::max((a + stop.a_peak) / dddq_max, 0.0);
  stop.hold_s = std::max(stop.hold_s, 0.0);
  stop.release_s = stop.a_peak / dddq_max;
  return stop;
}

double StopTravel(const JointStop& stop, double dq, double ddq, double t) noexcept {
  double x = 0.0;
  double v = stop.sign * dq;
  double a = stop.sign * ddq;
  double left = t;
  const double durations[3] = {stop.ramp_s, stop.hold_s, stop.release_s};
  const double jerks[3] = {-stop.jerk, 0.0, stop.jerk};
  for (int phase = 0; phase < 3; ++phase) {
    const double d = std::min(std::max(left, 0.0), durations[phase]);
    x += d * (v + d * (0.5 * a + d * jerks[phase] / 6.0));
    v += d * (a + 0.5 * d * jerks[phase]);
    a += d * jerks[phase];
    left -= d;
  }
  return stop.sign * x;
}

hal::LimitSet LimitsPassed(const ServoConfig& config, const Reference& reference, const model::VecN& q_now,
                           const model::Vec3& p_now) noexcept {
  const GuardConfig& guard = config.guard;
  const StopPlan plan = PlanAll(config, reference);
  // The ticks' own steps come on top of the continuous motion.
  const double duration = plan.duration_s + kPeriodS;

  // Joints: a joint is furthest out where it stops, unless it still turns round before.
  double travel = 0.0;
  for (int i = 0; i < reference.q.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    const double step = reference.dq[i] * kPeriodS;
    const double stop = StopTravel(plan.joints[k], reference.dq[i], reference.ddq[i], duration) + step;
    if (!Within(reference.q[i] + stop, q_now[i], joint.q_min + guard.joint_position_margin,
                joint.q_max - guard.joint_position_margin)) {
      return hal::Bit(hal::Limit::kJointPosition);
    }
    travel += std::fabs(reference.dq[i]) * duration + std::fabs(reference.ddq[i]) * duration * duration;
  }

  // Workspace: no point of the arm moves further than the joints' travel times its distance from their axes,
  // which is at most about two workspace radii. Far from the boundary that settles it.
  const double radius_now = p_now.norm();
  const double boundary = std::max(guard.workspace_radius - guard.workspace_margin, radius_now) + kSlack;
  const double reach = 2.0 * guard.workspace_radius * travel;
  const int num_obstacles = CountObstacles(guard.obstacles);
  std::array<double, 2 * Obstacles::kMost> least{};  // clearance of each that must be kept
  double nearest = HUGE_VAL;
  for (int i = 0; i < num_obstacles; ++i) {
    const double clearance = ClearanceOf(guard.obstacles, i, p_now).distance;
    least[static_cast<std::size_t>(i)] = std::min(guard.workspace_margin, clearance) - kSlack;
    nearest = std::min(nearest, clearance - guard.workspace_margin);
  }
  if (radius_now + reach < boundary && reach < nearest) {
    return 0;
  }
  model::VecN q = reference.q;
  model::ArmPoses poses;
  for (int sample = 0; sample < kStopSamples; ++sample) {
    // Denser at the start, which is what will be gone for certain.
    const double share = static_cast<double>(sample) / (kStopSamples - 1);
    const double t = duration * share * share;
    for (int i = 0; i < q.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      q[i] = reference.q[i] + reference.dq[i] * kPeriodS +
             StopTravel(plan.joints[k], reference.dq[i], reference.ddq[i], t);
    }
    model::ComputePoses(config.arm, q, poses);
    if (!(poses.X_BE.p.norm() <= boundary)) {
      return hal::Bit(hal::Limit::kWorkspace);
    }
    for (int i = 0; i < num_obstacles; ++i) {
      if (!(ClearanceOf(guard.obstacles, i, poses.X_BE.p).distance >= least[static_cast<std::size_t>(i)])) {
        return hal::Bit(hal::Limit::kObstacle);
      }
    }
  }
  return 0;
}

}  // namespace fovea::servo
