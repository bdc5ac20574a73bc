#include "firmware/core/barriers/motion_limits.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

// The row's boundary lies inside the guard's, and pushes back: on the guard's own boundary its proof would
// let nothing pass that moves along it, since every step along a sphere leads out of it.
constexpr double kInsideGuard = 0.002;  // [m]
constexpr double kReturnRate = 5.0;     // what is past the boundary goes back with this rate [1/s]
constexpr double kReturnSpeed = 0.02;   // but no faster [m/s]

}  // namespace

void MotionLimits::AddRow(const model::VecN& a, double b) noexcept {
  if (num_rows >= kMaxRows) {
    complete = false;
    return;
  }
  rows[static_cast<std::size_t>(num_rows)] = {a, b};
  ++num_rows;
}

bool MotionLimits::KeptBy(const model::VecN& dq) const noexcept {
  bool kept = complete;
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    kept = kept && dq[i] >= dq_min[i] && dq[i] <= dq_max[i];
  }
  for (int k = 0; k < num_rows; ++k) {
    const LimitRow& row = rows[static_cast<std::size_t>(k)];
    kept = kept && row.a.dot(dq) <= row.b;
  }
  return kept;
}

void LimitJoints(const config::ServoConfig& config, const model::VecN& q, MotionLimits& limits) noexcept {
  const config::GuardConfig& guard = config.guard;
  const Eigen::Index n = q.size();
  limits.num_rows = 0;
  limits.complete = true;
  limits.dq_min.resize(n);
  limits.dq_max.resize(n);
  for (int i = 0; i < n; ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    const double speed = guard.joint_velocity_fraction * joint.dq_max;
    const double room_up = joint.q_max - guard.joint_position_margin - q[i];
    const double room_down = q[i] - joint.q_min - guard.joint_position_margin;
    limits.dq_max[i] = std::min(speed, BarrierSpeed(room_up, pace.deceleration, pace.reaction_s));
    limits.dq_min[i] = -std::min(speed, BarrierSpeed(room_down, pace.deceleration, pace.reaction_s));
  }
}

void LimitAcceleration(const config::ServoConfig& config, const trajectory::Reference& reference,
                       MotionLimits& limits) noexcept {
  for (int i = 0; i < reference.dq.size(); ++i) {
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    const double change = pace.ddq_max * pace.ramp_s;
    const double dq_min = limits.dq_min[i];
    const double dq_max = limits.dq_max[i];
    limits.dq_min[i] = std::clamp(reference.dq[i] - change, dq_min, dq_max);
    limits.dq_max[i] = std::clamp(reference.dq[i] + change, dq_min, dq_max);
  }
}

void LimitOutwardMotion(const config::ServoConfig& config, const model::Vec3& p_BE,
                        const model::LinearJacobian& J_E_B, const model::VecN& dq,
                        MotionLimits& limits) noexcept {
  const config::GuardConfig& guard = config.guard;
  const double radius = p_BE.norm();
  if (radius < 1e-6) {
    return;  // at the centre every direction leads out, and none is near the boundary
  }
  const model::Vec3 outward = p_BE / radius;
  const model::Vec3 v_E = J_E_B.lazyProduct(dq);
  const double v_out = v_E.dot(outward);
  // Along the boundary the centripetal share of the deceleration is spent, at most half of it.
  const double spent = (v_E - v_out * outward).squaredNorm() / radius;
  const double deceleration =
      std::max(guard.workspace_deceleration - spent, 0.5 * guard.workspace_deceleration);
  const double distance = guard.workspace_radius - guard.workspace_margin - kInsideGuard - radius;
  const double v_max = distance > 0.0
                           ? BarrierSpeed(distance, deceleration, trajectory::SlowestReaction(config))
                           : std::max(kReturnRate * distance, -kReturnSpeed);
  const model::VecN a = J_E_B.transpose().lazyProduct(outward);
  limits.AddRow(a, v_max);
}

double ScaleIntoRange(const MotionLimits& limits, model::VecN& dq) noexcept {
  double scale = 1.0;
  for (int i = 0; i < dq.size(); ++i) {
    if (dq[i] > 0.0 && limits.dq_max[i] >= 0.0 && dq[i] * scale > limits.dq_max[i]) {
      scale = limits.dq_max[i] / dq[i];
    } else if (dq[i] < 0.0 && limits.dq_min[i] <= 0.0 && dq[i] * scale < limits.dq_min[i]) {
      scale = limits.dq_min[i] / dq[i];
    }
  }
  for (int i = 0; i < dq.size(); ++i) {
    dq[i] = std::min(std::max(scale * dq[i], limits.dq_min[i]), limits.dq_max[i]);
  }
  return scale;
}

}  // namespace fovea::barriers
