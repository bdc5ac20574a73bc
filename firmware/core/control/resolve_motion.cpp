#include "firmware/core/control/resolve_motion.hpp"

#include <algorithm>
#include <array>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/barriers/disc_tilt_barrier.hpp"
#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/control/null_space_wish.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::control {
namespace {

using hal::Bit;
using hal::Limit;
using hal::LimitSet;

constexpr double kWishFades = 0.5;

// Rows, and what each stands for.
struct NamedLimits {
  barriers::MotionLimits limits;
  std::array<Limit, barriers::MotionLimits::kMaxRows> names{};

  void NameNewRows(Limit limit, int before) noexcept {
    for (int k = before; k < limits.num_rows; ++k) {
      names[static_cast<std::size_t>(k)] = limit;
    }
  }
};

// The guard proves a stop before each obstacle; the row keeps it from having to.
void LimitApproach(const config::ServoConfig& config, const MotionScene& scene,
                   barriers::MotionLimits& limits) noexcept {
  const config::Obstacles& obstacles = config.guard.obstacles;
  const double deceleration = 0.5 * config.guard.workspace_deceleration;
  const int num_obstacles = barriers::CountObstacles(obstacles);
  const double reaction_s = num_obstacles > 0 ? trajectory::SlowestReaction(config) : 0.0;
  for (int i = 0; i < num_obstacles; ++i) {
    const barriers::HandClearance hand =
        barriers::ClearanceOf(obstacles, i, config.guard.hand, scene.poses.X_BE);
    const double room = hand.clearance.distance - 2.0 * config.guard.workspace_margin;
    const double speed = barriers::BarrierSpeed(room, deceleration, reaction_s);
    model::LinearJacobian J;
    model::ComputeLinearJacobian(config.arm, scene.poses, hand.p_BP, J);
    limits.AddRow(-J.transpose().lazyProduct(hand.clearance.away), speed);
  }
}

// A wish is nothing to get into a singularity for: from half as deep again as the limit on it fades. (At the
// limit it would take its joints' freedom from the task, by a gradient that leaps where two singular values
// meet.)
double ShareOfWish(double sigma, double sigma_min) noexcept {
  return std::clamp((sigma / sigma_min - 1.0) / kWishFades, 0.0, 1.0);
}

void Gather(const config::ServoConfig& config, const MotionScene& scene, barriers::SingularityWatch& watch,
            NamedLimits& named, double& wish) noexcept {
  barriers::MotionLimits& limits = named.limits;
  barriers::LimitJoints(config, scene.reference.q, limits);
  barriers::LimitOutwardMotion(config, scene.poses.X_BE.p, scene.J_E_B, scene.reference.dq, limits);
  named.NameNewRows(Limit::kWorkspace, 0);
  int rows = limits.num_rows;
  LimitApproach(config, scene, limits);
  const barriers::ArmLine line = barriers::LineOfArm(config.arm, scene.poses);
  barriers::LimitArm(config, scene.poses, line, limits);
  barriers::LimitHand(config.guard.hand_clearance, config.arm, scene.poses, line, limits);
  named.NameNewRows(Limit::kObstacle, rows);
  if (scene.by_joints) {
    watch = barriers::SingularityWatch{};  // what it knew of the posture holds no longer
  } else if (config.guard.singularity_min > 0.0) {
    rows = limits.num_rows;
    barriers::SingularityConfig singularity_config;
    singularity_config.sigma_min = config.guard.singularity_min;
    barriers::Singularity singularity;
    if (barriers::IsNear(singularity_config, scene.J, scene.reference.dq.lpNorm<1>(),
                         2.0 * config.guard.workspace_radius, watch, singularity)) {
      barriers::LimitSingularity(singularity_config, singularity, limits);
      wish = ShareOfWish(singularity.sigma, singularity_config.sigma_min);
      named.NameNewRows(Limit::kSingularity, rows);
    }
  }
  if (scene.target != nullptr) {
    rows = limits.num_rows;
    barriers::LimitView(config.guard.view, *scene.target, limits);
    const model::Pose X_BC = scene.poses.X_BE * config.X_EC;
    barriers::LimitSight(config.guard.sight_clearance, config.arm,
                         {scene.poses, line, X_BC, scene.target->outline, X_BC * scene.target->seen.X_CO},
                         scene.target->J_C, limits);
    if (config.guard.view.enabled && !scene.target->normal_C.isZero()) {
      barriers::LimitTilt(config.guard.view.disc_cosine_min, scene.target->seen.X_CO.p,
                          scene.target->normal_C, scene.target->J_C, limits);
    }
    named.NameNewRows(Limit::kFieldOfView, rows);
  }
}

LimitSet LimitsThatAct(const config::ServoConfig& config, const NamedLimits& named,
                       const LimitedMotion& motion) noexcept {
  LimitSet active = 0;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const double speed =
        config.guard.joint_velocity_fraction * config.arm.joints[static_cast<std::size_t>(i)].dq_max;
    const bool up = ((motion.upper >> i) & 1U) != 0;
    const bool down = ((motion.lower >> i) & 1U) != 0;
    if (up || down) {
      const double bound = up ? named.limits.dq_max[i] : -named.limits.dq_min[i];
      active |= Bit(bound < speed ? Limit::kJointPosition : Limit::kJointVelocity);
    }
  }
  for (int k = 0; k < named.limits.num_rows; ++k) {
    if (((motion.rows >> k) & 1U) != 0) {
      active |= Bit(named.names[static_cast<std::size_t>(k)]);
    }
  }
  return active;
}

}  // namespace

void ResolveMotion(const config::ServoConfig& config, const MotionTask& task, const MotionScene& scene,
                   ResolvedMotion& motion) noexcept {
  NamedLimits named;
  double wish = 1.0;
  Gather(config, scene, motion.watch, named, wish);
  ConstrainedConfig constrained;
  constrained.damping.threshold = config.law.damping;
  if (scene.by_joints) {
    constrained.progress_weight = 1.0;
  }
  ConstrainedMotion resolved;
  if (wish < 1.0) {
    MotionTask calmer = task;
    calmer.dq_0 *= wish;
    ResolveConstrained(constrained, calmer, named.limits, resolved);
  } else {
    ResolveConstrained(constrained, task, named.limits, resolved);
  }
  motion.dq = resolved.limited.dq;
  motion.finite = resolved.limited.outcome != LimitOutcome::kNotFinite;
  motion.limits = LimitsThatAct(config, named, resolved.limited);
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
