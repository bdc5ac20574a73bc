// SPDX-License-Identifier: Apache-2.0
// A closed loop without dynamics, to compare methods of kinematic resolution on the same starts: the arm
// follows its reference exactly, the camera measures the ball's centre without delay or noise.
//
// Sampler: start and goal postures are uniform in the joints' range minus 5 degrees at each end, each with
// |p_BE| <= 0.82 m and the hand above the table (p_BE z >= 0.1 m). The ball is where the goal posture sees it
// at its goal, 0.40 m away on the camera's axis, and not below the table. The start must see it at a depth of
// 0.15 to 1.2 m, 30 px inside a picture of 640x480 with f = 554.256 px, and more than 150 px or 0.1 m of
// depth away from its goal. So a posture that reaches the goal exists, but perhaps no path to it.
#pragma once

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>

#include "firmware/core/barriers/workspace_barrier.hpp"
#include "firmware/core/control/null_space_wish.hpp"
#include "firmware/core/control/resolve_constrained.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "fovea/hal/types.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::control::resolve_loop {

constexpr double kTickS = hal::kTickPeriodS;
constexpr double kFocal = 554.256;  // [px]

struct Start {
  model::VecN q;
  model::Vec3 p_BO;
};

struct Seen {
  double u_px = 0.0, v_px = 0.0, depth = 0.0;
  // True inside the picture minus a margin.
  [[nodiscard]] bool Inside(double margin_px) const {
    return depth > 0.0 && std::abs(u_px) <= 319.5 - margin_px && std::abs(v_px) <= 239.5 - margin_px;
  }
};

inline Seen See(const model::Vec3& p_CO_C) {
  return {kFocal * p_CO_C.x() / p_CO_C.z(), kFocal * p_CO_C.y() / p_CO_C.z(), p_CO_C.z()};
}

inline model::ArmPoses PosesAt(const config::ServoConfig& config, const model::VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses;
}

inline Start Sample(test::RandomStates& random, const config::ServoConfig& config) {
  constexpr double kMargin = 5.0 * model::kPi / 180.0;
  const auto posture = [&](model::ArmPoses& poses) {
    for (;;) {
      model::VecN q(config.arm.num_joints);
      for (int i = 0; i < q.size(); ++i) {
        const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
        q[i] = random.Uniform(joint.q_min + kMargin, joint.q_max - kMargin);
      }
      poses = PosesAt(config, q);
      if (poses.X_BE.p.norm() <= 0.82 && poses.X_BE.p.z() >= 0.1) {
        return q;
      }
    }
  };
  for (;;) {
    model::ArmPoses start;
    model::ArmPoses goal;
    const model::VecN q = posture(start);
    posture(goal);
    const model::Vec3 p_BO = goal.X_BE * config.X_EC * config.feature.p_CO_C_star;
    const Seen seen = See((start.X_BE * config.X_EC).Inverse() * p_BO);
    const bool far = std::hypot(seen.u_px, seen.v_px) > 150.0 || std::abs(seen.depth - 0.4) > 0.1;
    if (p_BO.z() >= 0.04 && seen.depth >= 0.15 && seen.depth <= 1.2 && seen.Inside(30.0) && far) {
      return {q, p_BO};
    }
  }
}

// Inputs of a resolution method, all computed from the reference.
struct Scene {
  const config::ServoConfig& config;
  const features::FeatureState& feature;
  const model::ArmPoses& poses;
  const model::Mat6N& J_C;
  const model::LinearJacobian& J_E_B;
  const trajectory::Reference& reference;
};
using Resolve = std::function<model::VecN(const Scene&)>;

struct Run {
  bool converged = false;      // the error goes below 2 % of its start and stays there until `limit_s`
  double settle_s = 0.0;       // when the error was last above that
  double final_share = 1.0;    // final error as a share of the first
  double dq_largest = 0.0;     // |dq| of the reference [rad/s]
  double path_px = 0.0;        // length of the centre's path in the image
  double straight_px = 0.0;    // straight distance from its start to its end
  double out_of_view_s = 0.0;  // time outside the picture
  double radius = 0.0;         // largest |p_BE| [m]
  double range_used = 0.0;     // largest share used of a joint's range minus its margin
};

inline Run Loop(const config::ServoConfig& config, const Start& start, const Resolve& resolve,
                double limit_s) {
  trajectory::Reference reference{start.q, model::VecN::Zero(start.q.size()),
                                  model::VecN::Zero(start.q.size())};
  Run run;
  double e_start = 0.0;
  Seen first, before;
  guard::KnownClearances known;
  const int ticks = static_cast<int>(limit_s / kTickS);
  for (int tick = 0; tick < ticks; ++tick) {
    const model::ArmPoses poses = PosesAt(config, reference.q);
    const model::Pose X_CB = (poses.X_BE * config.X_EC).Inverse();
    features::FeatureState feature;
    if (!config.feature.Compute({{model::Mat3::Identity(), X_CB * start.p_BO}}, feature)) {
      return run;  // behind the camera: lost
    }
    const Seen seen = See(X_CB * start.p_BO);
    const double e = (feature.s_star - feature.s).norm();
    if (tick == 0) {
      e_start = e;
      first = before = seen;
    }
    run.final_share = e / e_start;
    run.converged = run.final_share < 0.02;
    run.settle_s = run.converged ? run.settle_s : (tick + 1) * kTickS;
    run.path_px += std::hypot(seen.u_px - before.u_px, seen.v_px - before.v_px);
    run.straight_px = std::hypot(seen.u_px - first.u_px, seen.v_px - first.v_px);
    run.out_of_view_s += seen.Inside(0.0) ? 0.0 : kTickS;
    run.radius = std::max(run.radius, poses.X_BE.p.norm());
    run.dq_largest = std::max(run.dq_largest, reference.dq.norm());
    for (int i = 0; i < reference.q.size(); ++i) {
      const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
      const double half = 0.5 * (joint.q_max - joint.q_min) - config.guard.joint_position_margin;
      run.range_used =
          std::max(run.range_used, std::abs(reference.q[i] - 0.5 * (joint.q_max + joint.q_min)) / half);
    }
    before = seen;
    if (run.final_share < 1e-3) {
      return run;
    }
    model::Mat6N J_C;
    model::LinearJacobian J_E_B;
    model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
    model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
    const model::VecN wish = resolve({config, feature, poses, J_C, J_E_B, reference});
    const double x = std::min(tick * kTickS / config.law.smooth_start_s, 1.0);
    const model::VecN dq_des = x * x * (3.0 - 2.0 * x) * wish;
    guard::GuardMotion(config, guard::MotionWish::Velocity(dq_des), poses.X_BE.p, J_E_B, known, reference);
  }
  return run;
}

// Resolution methods. `wishes`: goals for the free directions.

// The usual method, for comparison: the pseudo-inverse with one damping for all directions, and an unbounded
// pull towards the posture.
inline model::VecN ByFixedDamping(const Scene& scene) {
  constexpr double kDamping = 0.01;  // relative to the Jacobian's size
  const Eigen::MatrixXd J = scene.feature.L_s * scene.J_C;
  const Eigen::VectorXd v =
      scene.config.law.lambda * (scene.feature.s_star - scene.feature.s) - scene.feature.ds_dt_target;
  const int n = static_cast<int>(scene.reference.q.size());
  const Eigen::VectorXd dq_0 =
      scene.config.law.posture_gain * (model::ToVector(scene.config.law.q_posture, n) - scene.reference.q);
  Eigen::MatrixXd A = J * J.transpose();
  A.diagonal().array() += kDamping * kDamping * A.trace() / static_cast<double>(A.rows());
  return dq_0 + J.transpose() * A.ldlt().solve(v - J * dq_0);
}

inline MotionTask TaskOf(const Scene& scene, const NullSpaceConfig& wishes) {
  MotionTask task;
  task.J = scene.feature.L_s.lazyProduct(scene.J_C);
  task.v = scene.config.law.lambda * (scene.feature.s_star - scene.feature.s) - scene.feature.ds_dt_target;
  task.dq_0 = NullSpaceWish(wishes, scene.config.arm, scene.reference.q, scene.J_C);
  task.weight = model::VecN::Ones(scene.reference.q.size());
  return task;
}

inline model::VecN ByDamped(const Scene& scene, const NullSpaceConfig& wishes) {
  DampedMotion motion;
  ResolveDamped(DampingConfig{}, TaskOf(scene, wishes), motion);
  return motion.dq;
}

inline model::VecN ByConstrained(const Scene& scene, const NullSpaceConfig& wishes,
                                 const ConstrainedConfig& config, bool acceleration) {
  barriers::MotionLimits limits;
  barriers::LimitJoints(scene.config, scene.reference.q, limits);
  if (acceleration) {
    barriers::LimitAcceleration(scene.config, scene.reference, limits);
  }
  limits.Add(barriers::WorkspaceRow(scene.config, scene.poses.X_BE.p, scene.J_E_B, scene.reference.dq));
  ConstrainedMotion motion;
  ResolveConstrained(config, TaskOf(scene, wishes), limits, motion);
  return motion.limited.dq;
}

// Only the pull towards the posture, with the visual law's gain, no faster than `speed_max` [rad/s].
inline NullSpaceConfig PostureOnly(const config::ServoConfig& config, double speed_max) {
  NullSpaceConfig wishes;
  wishes.posture_gain = config.law.posture_gain;
  wishes.q_posture = config.law.q_posture;
  wishes.joint_limit_gain = 0.0;
  wishes.manipulability_gain = 0.0;
  wishes.speed_max = speed_max;
  return wishes;
}

inline NullSpaceConfig AllWishes(const config::ServoConfig& config) {
  NullSpaceConfig wishes;
  wishes.posture_gain = config.law.posture_gain;
  wishes.q_posture = config.law.q_posture;
  return wishes;
}

}  // namespace fovea::control::resolve_loop
