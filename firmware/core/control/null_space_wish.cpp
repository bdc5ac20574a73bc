// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/null_space_wish.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/cholesky.hpp"

namespace fovea::control {

model::VecN JointLimitWish(const model::ArmModel& arm, const model::VecN& q, double onset) noexcept {
  model::VecN wish = model::VecN::Zero(q.size());
  for (int i = 0; i < q.size(); ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double half = 0.5 * (joint.q_max - joint.q_min);
    const double width = half * (1.0 - onset);
    if (!(width > 0.0)) {
      continue;
    }
    const double off_middle = q[i] - 0.5 * (joint.q_max + joint.q_min);
    const double into = std::clamp((std::fabs(off_middle) - onset * half) / width, 0.0, 1.0);
    wish[i] = -std::copysign(width * into * into, off_middle);
  }
  return wish;
}

model::VecN ManipulabilityGradient(const model::Mat6N& J, double length, double soft) noexcept {
  const int n = static_cast<int>(J.cols());
  model::Mat6N scaled = J;
  scaled.topRows<3>() /= length;
  model::Mat6 A = scaled.lazyProduct(scaled.transpose());
  A.diagonal().array() += soft * soft;
  model::FactorCholesky(A);
  // dm/dq_k = trace(A^-1 (dJ/dq_k) J^T) = sum over j of (A^-1 J_j) . dJ_j/dq_k
  model::VecN gradient = model::VecN::Zero(n);
  for (int j = 0; j + 1 < n; ++j) {
    model::Vec6 y = scaled.col(j);
    model::SolveLower(A, y);
    model::SolveLowerTransposed(A, y);
    y.head<3>() /= length;  // so that it multiplies changes of the unscaled J
    for (int k = j + 1; k < n; ++k) {
      gradient[k] += y.dot(model::ColumnChange(J, j, k));
    }
  }
  return gradient;
}

model::VecN NullSpaceWish(const NullSpaceConfig& config, const model::ArmModel& arm, const model::VecN& q,
                          const model::Mat6N& J) noexcept {
  const int n = static_cast<int>(q.size());
  model::VecN wish = config.posture_gain * (model::ToVector(config.q_posture, n) - q);
  if (config.joint_limit_gain > 0.0) {
    wish += config.joint_limit_gain * JointLimitWish(arm, q, config.joint_limit_onset);
  }
  if (config.manipulability_gain > 0.0) {
    wish += config.manipulability_gain * ManipulabilityGradient(J, config.length, config.manipulability_soft);
  }
  const double bound2 = config.speed_max * config.speed_max;
  wish *= std::sqrt(bound2 / (bound2 + wish.squaredNorm()));
  return wish;
}

}  // namespace fovea::control
