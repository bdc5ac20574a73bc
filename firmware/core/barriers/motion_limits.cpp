// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/motion_limits.hpp"

#include <algorithm>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
void MotionLimits::Add(const Barrier& barrier) noexcept {
  if (barrier.value == HUGE_VAL) {
    return;
  }
  if (LimitRow* row = NewRow()) {
    row->a = -barrier.gradient;
    row->b = barrier.SpeedMost();
    row->name = barrier.name;
  }
}

void MotionLimits::AddRow(const model::VecN& a, double b) noexcept {
  if (LimitRow* row = NewRow()) {
    *row = {a, b};
  }
}

LimitRow* MotionLimits::NewRow() noexcept {
  if (num_rows >= kMaxRows) {
    complete = false;
    return nullptr;
  }
  return &rows[static_cast<std::size_t>(num_rows++)];
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
