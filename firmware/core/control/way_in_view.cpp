// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/way_in_view.hpp"

#include <algorithm>

#include "firmware/core/control/posture_checks.hpp"
#include "firmware/core/features/point.hpp"

namespace fovea::control {

model::VecN WayInView(const model::VecN& to_goal, const features::TargetInCamera& seen,
                      const model::Mat6N& J_C, const model::Vec3& p_CO_C_star) noexcept {
  constexpr double kDamping = 1e-6;  // of A A^T [rad^-2], which is of the order of 1
  features::ImagePoint centre;
  if (!features::ComputePoint(seen, model::Vec3::Zero(), centre)) {
    return to_goal;
  }
  const model::VecN a_x = J_C.transpose().lazyProduct(centre.L.row(0).transpose());
  const model::VecN a_y = J_C.transpose().lazyProduct(centre.L.row(1).transpose());
  const double xx = a_x.squaredNorm() + kDamping;
  const double yy = a_y.squaredNorm() + kDamping;
  const double xy = a_x.dot(a_y);
  const double det = xx * yy - xy * xy;  // > 0: at least kDamping times the larger
  const double r_x = a_x.dot(to_goal) + centre.xy.x() - p_CO_C_star.x() / p_CO_C_star.z();
  const double r_y = a_y.dot(to_goal) + centre.xy.y() - p_CO_C_star.y() / p_CO_C_star.z();
  return to_goal - ((yy * r_x - xy * r_y) / det) * a_x - ((xx * r_y - xy * r_x) / det) * a_y;
}

bool StepOnWay(const config::ServoConfig& config, const model::Pose& X_BO, const model::VecN& q_goal,
               WayTrial& way) noexcept {
  constexpr double kStep = 0.15;   // [rad]
  constexpr double kShort = 0.02;  // a shorter step counts as stuck [rad]
  constexpr int kStepsMost = 60;
  constexpr int kStepsToTurnIn = 2;  // until a target at the edge is in view
  model::ArmPoses poses;
  model::ComputePoses(config.arm, way.q, poses);
  const model::Pose X_BC = poses.X_BE * config.X_EC;
  const bool clear =
      IsInView(config, X_BC, X_BO) && KeepsOut(config, poses.X_BE) && IsArmClear(config, poses, X_BO);
  model::VecN step = q_goal - way.q;
  const double left = step.lpNorm<Eigen::Infinity>();
  way.barred = way.barred || (way.steps >= kStepsToTurnIn && !clear) || way.steps >= kStepsMost;
  if (way.barred || left <= kStep) {
    way.length += left;
    return false;
  }
  model::Mat6N J_C;
  model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
  step = WayInView(step, {X_BC.Inverse() * X_BO, model::Vec3::Zero(), model::Vec3::Zero()}, J_C,
                   config.feature.p_CO_C_star);
  step *= std::min(kStep / std::max(step.lpNorm<Eigen::Infinity>(), kShort), 1.0);
  const model::VecN before = way.q;
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const JointRange range = RoomOfJoint(config, i);
    const double least = std::min(range.least, before[i]);  // the arm's own posture is allowed
    const double most = std::max(range.most, before[i]);
    way.q[i] = std::clamp(before[i] + step[i], least, most);
  }
  const double done = (way.q - before).lpNorm<Eigen::Infinity>();
  ++way.steps;
  way.length += done;
  way.barred = done < kShort;
  return true;
}

}  // namespace fovea::control
