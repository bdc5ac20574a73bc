// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/posture_checks.hpp"

#include <algorithm>

#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"

namespace fovea::control {
namespace {

constexpr double kJointRoom = 0.06;       // inside the reference's range [rad, m]
constexpr double kRadiusRoom = 0.003;     // inside the reference's sphere [m]
constexpr double kLineRoom = 0.005;       // beyond the guard's clearances [m]
constexpr double kSingularityRoom = 1.5;  // times the guard's smallest singular value

constexpr double kSteepest = 0.2;  // smallest cosine to a flat target's normal for its detection
constexpr double kNearest = 0.05;  // [m]

}  // namespace

JointRange RoomOfJoint(const config::ServoConfig& config, Eigen::Index i) noexcept {
  const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
  const double room =
      std::min(config.guard.joint_position_margin + kJointRoom, 0.5 * (joint.q_max - joint.q_min));
  return {joint.q_min + room, joint.q_max - room};
}

bool KeepsOut(const config::ServoConfig& config, const model::Pose& X_BE) noexcept {
  const config::GuardConfig& guard = config.guard;
  bool keeps = X_BE.p.norm() <= guard.workspace_radius - guard.workspace_margin - kRadiusRoom;
  for (int i = 0; i < barriers::CountObstacles(guard.obstacles); ++i) {
    keeps = keeps && barriers::ClearanceOf(guard.obstacles, i, guard.hand, X_BE).clearance.distance >
                         2.0 * guard.workspace_margin;
  }
  return keeps;
}

bool IsRegular(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept {
  model::Mat6N J;
  model::ComputeJacobian(config.arm, poses, config.X_EC, J);
  barriers::Singularity singularity;
  barriers::ComputeSingularity(J, barriers::SingularityConfig{}.length, singularity);
  return singularity.sigma > kSingularityRoom * config.guard.singularity_min;
}

bool IsArmClear(const config::ServoConfig& config, const model::ArmPoses& poses,
                const model::Pose& X_BO) noexcept {
  const config::GuardConfig& guard = config.guard;
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, poses);
  const barriers::Sight sight{poses, bodies, poses.X_BE * config.X_EC, config.feature.Outline(), X_BO};
  return barriers::ClearanceOfPlanes(guard, bodies) > guard.link_clearance + kLineRoom &&
         (guard.self_clearance <= 0.0 ||
          barriers::SelfClearance(config.arm, bodies) > guard.self_clearance + kLineRoom) &&
         (guard.sight_clearance <= 0.0 ||
          barriers::ClearanceOfSight(sight) > guard.sight_clearance + kLineRoom);
}

bool IsInView(const config::ServoConfig& config, const model::Pose& X_BC, const model::Pose& X_BO) noexcept {
  const config::ViewConfig& view = config.guard.view;
  const model::Pose X_CO = X_BC.Inverse() * X_BO;
  const bool is_flat = config.feature.SeesOrientation();
  if (is_flat && !(X_CO.R.col(2).dot(X_CO.p) > kSteepest * X_CO.p.norm())) {
    return false;
  }
  const features::TargetOutline outline = config.feature.Outline();
  for (std::size_t i = 0; i < static_cast<std::size_t>(outline.num_points); ++i) {
    const model::Vec3 p = X_CO * outline.p_OP[i];
    if (!(p.z() > kNearest)) {
      return false;
    }
    const double x = p.x() / p.z();
    const double y = p.y() / p.z();
    const double reach = outline.radius / p.z();
    if (view.enabled && !(x - reach > view.x_min && x + reach < view.x_max && y - reach > view.y_min &&
                          y + reach < view.y_max)) {
      return false;
    }
  }
  return true;
}

}  // namespace fovea::control
