// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/resolve_motion.hpp"

#include <algorithm>

#include "firmware/core/barriers/disc_tilt_barrier.hpp"
#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/control/null_space_wish.hpp"

namespace fovea::control {
namespace {

using hal::Bit;
using hal::Limit;
using hal::LimitSet;

constexpr double kWishFades = 0.5;

// The wish fades out towards a singularity, from 1.5 times the limit down to the limit. (At the limit it
// would take freedom from the task, along a gradient that jumps where two singular values meet.)
double ShareOfWish(double sigma, double sigma_min) noexcept {
  return std::clamp((sigma / sigma_min - 1.0) / kWishFades, 0.0, 1.0);
}

double SpeedOf(const config::ServoConfig& config, int joint) noexcept {
  return config.guard.joint_velocity_fraction * config.arm.joints[static_cast<std::size_t>(joint)].dq_max;
}

void Gather(const config::ServoConfig& config, const MotionScene& scene, barriers::SingularityWatch& watch,
            barriers::MotionLimits& limits, double& wish) noexcept {
  barriers::LimitJoints(config, scene.reference.q, limits);
  if (scene.speed_share < 1.0) {
    for (int i = 0; i < config.arm.num_joints; ++i) {
      const double most = scene.speed_share * SpeedOf(config, i);
      limits.dq_max[i] = std::min(limits.dq_max[i], most);
      limits.dq_min[i] = std::max(limits.dq_min[i], -most);
    }
  }
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, scene.poses);
  const barriers::SolidBarriers solid(config);
  for (int i = 0; i < solid.size(); ++i) {
    limits.Add(solid.RowOf(i, {scene.poses, bodies, scene.J_E_B, scene.reference.dq}));
  }
  if (scene.by_joints) {
    watch = barriers::SingularityWatch{};  // its stored value is no longer valid
  } else if (config.guard.singularity_min > 0.0) {
    barriers::SingularityConfig singularity_config;
    singularity_config.sigma_min = config.guard.singularity_min;
    barriers::Singularity singularity;
    if (barriers::IsNear(singularity_config, scene.J, scene.reference.dq.lpNorm<1>(),
                         2.0 * config.guard.workspace_radius, watch, singularity)) {
      limits.Add(barriers::SingularityBarrier(singularity_config, singularity));
      wish = ShareOfWish(singularity.sigma, singularity_config.sigma_min);
    }
  }
  if (scene.target != nullptr) {
    for (const barriers::Barrier& side :
         scene.by_joints ? barriers::FieldOfViewBarriersOnPlan(config.guard, *scene.target)
                         : barriers::FieldOfViewBarriers(config.guard, *scene.target)) {
      limits.Add(side);
    }
    const model::Pose X_BC = scene.poses.X_BE * config.X_EC;
    limits.Add(barriers::LineOfSightBarrier(config,
                                            {scene.poses, bodies, X_BC, scene.target->outline,
                                             X_BC * scene.target->seen.X_CO, config.guard.obstacles},
                                            scene.target->J_C));
    if (config.guard.view.enabled && !scene.target->normal_C.isZero()) {
      limits.Add(barriers::DiscTiltBarrier(config.guard, scene.target->seen.X_CO.p, scene.target->normal_C,
                                           scene.target->J_C));
    }
  }
}

LimitSet LimitsThatAct(const config::ServoConfig& config, const barriers::MotionLimits& limits,
                       const LimitedMotion& motion) noexcept {
  LimitSet active = 0;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const double speed = SpeedOf(config, i);
    const bool up = ((motion.upper >> i) & 1U) != 0;
    const bool down = ((motion.lower >> i) & 1U) != 0;
    if (up || down) {
      const double bound = up ? limits.dq_max[i] : -limits.dq_min[i];
      active |= Bit(bound < speed ? Limit::kJointPosition : Limit::kJointVelocity);
    }
  }
  for (int k = 0; k < limits.num_rows; ++k) {
    if (((motion.rows >> k) & 1U) != 0) {
      active |= Bit(limits.rows[static_cast<std::size_t>(k)].name);
    }
  }
  return active;
}

}  // namespace

void ResolveMotion(const config::ServoConfig& config, const MotionTask& task, const MotionScene& scene,
                   ResolvedMotion& motion) noexcept {
  barriers::MotionLimits limits;
  double wish = 1.0;
  Gather(config, scene, motion.watch, limits, wish);
  if (scene.by_joints && limits.KeptBy(task.v)) {  // nothing to resolve: the task is the joints' own motion
    motion.dq = task.v;
    motion.finite = true;
    motion.limits = 0;
    return;
  }
  ConstrainedConfig constrained;
  constrained.damping.threshold = config.law.damping;
  if (scene.by_joints) {
    constrained.progress_weight = 1.0;
  }
  ConstrainedMotion resolved;
  if (wish < 1.0) {
    MotionTask calmer = task;
    calmer.dq_0 *= wish;
    ResolveConstrained(constrained, calmer, limits, resolved);
  } else {
    ResolveConstrained(constrained, task, limits, resolved);
  }
  motion.dq = resolved.limited.dq;
  motion.finite = resolved.limited.outcome != LimitOutcome::kNotFinite;
  motion.limits = LimitsThatAct(config, limits, resolved.limited);
}

model::VecN FreeWish(const config::LawConfig& config, const model::ArmModel& arm, const model::VecN& q,
                     const model::Mat6N& J) noexcept {
  NullSpaceConfig wishes;
  wishes.posture_gain = config.posture_gain;
  wishes.q_posture = config.q_posture;
  wishes.joint_limit_gain = config.joint_limit_gain;
  wishes.manipulability_gain = config.manipulability_gain;
  wishes.speed_max = config.free_speed;
  return NullSpaceWish(wishes, arm, q, J);
}

}  // namespace fovea::control
