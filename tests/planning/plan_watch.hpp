// SPDX-License-Identifier: Apache-2.0
// Checks a plan at 1 kHz with nothing of the planner: limits by finite differences, barriers by their values,
// and the guard, which must let the plan pass.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "firmware/core/features/equal_turn.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "tests/planning/starts.hpp"

namespace fovea::test {

// The worst over a plan, or over several.
struct PlanResidual {
  double velocity = 0.0;  // share of the limit
  double acceleration = 0.0;
  double jerk = 0.0;
  double solid = HUGE_VAL;       // room before what the guard's proof of a stop allows [m]
  double picture_px = HUGE_VAL;  // room before the picture's bound
  double sight = HUGE_VAL;       // room before the guard's clearance [m]
  double facing = HUGE_VAL;      // cosine to a flat target's normal, more than is needed for its detection
  double corner_deg = HUGE_VAL;  // a corner's angle in the picture, more than is needed for its detection
  double tilt = HUGE_VAL;        // room before a disc's largest tilt, or its tilt at the start: cosine
  double feature = 0.0;          // error at the end
  double start = 0.0;            // distance of the first posture from the start's [rad]
  double guarded = 0.0;          // distance of the guard's reference from the plan [rad]
  int held_ticks = 0;            // ticks in which the guard acted

  void Add(const PlanResidual& other) {
    velocity = std::max(velocity, other.velocity);
    acceleration = std::max(acceleration, other.acceleration);
    jerk = std::max(jerk, other.jerk);
    solid = std::min(solid, other.solid);
    picture_px = std::min(picture_px, other.picture_px);
    sight = std::min(sight, other.sight);
    facing = std::min(facing, other.facing);
    corner_deg = std::min(corner_deg, other.corner_deg);
    tilt = std::min(tilt, other.tilt);
    feature = std::max(feature, other.feature);
    start = std::max(start, other.start);
    guarded = std::max(guarded, other.guarded);
    held_ticks += other.held_ticks;
  }
};

class PlanWatch {
 public:
  PlanWatch(const config::ServoConfig& config, const trajectory::PlanRequest& request)
      : config_(config), request_(request), solid_(config) {}

  PlanResidual Watch(const trajectory::Plan& plan) {
    PlanResidual residual;
    trajectory::Reference at;
    plan.At(0.0, at);
    residual.start = (at.q - request_.start.q).lpNorm<Eigen::Infinity>();
    trajectory::Reference guarded = request_.start;
    // q at this tick and at the three before it.
    std::array<model::VecN, 4> q;
    q.fill(at.q);
    const int ticks = static_cast<int>(plan.Duration() * 1e3) + 5;
    for (int tick = 0; tick <= ticks; ++tick) {
      plan.At(1e-3 * tick, at);
      std::rotate(q.begin(), q.begin() + 3, q.end());
      q[0] = at.q;
      WatchMotion(q, residual);
      WatchPlaces(at.q, residual);
      residual.held_ticks += Guard(at, guarded) ? 1 : 0;
      residual.guarded = std::max(residual.guarded, (guarded.q - at.q).lpNorm<Eigen::Infinity>());
    }
    residual.feature = FeatureError(at.q, plan.turn);
    return residual;
  }

 private:
  void WatchMotion(const std::array<model::VecN, 4>& q, PlanResidual& residual) const {
    for (int i = 0; i < config_.arm.num_joints; ++i) {
      const trajectory::JointPace pace = trajectory::PaceOf(config_, i);
      const double v_max =
          config_.guard.joint_velocity_fraction * config_.arm.joints[static_cast<std::size_t>(i)].dq_max;
      const double step = q[0][i] - q[1][i];
      const double second = step - (q[1][i] - q[2][i]);
      const double third = second - (q[1][i] - 2.0 * q[2][i] + q[3][i]);
      residual.velocity = std::max(residual.velocity, std::fabs(step) / 1e-3 / v_max);
      residual.acceleration = std::max(residual.acceleration, std::fabs(second) / 1e-6 / pace.ddq_max);
      residual.jerk = std::max(residual.jerk, std::fabs(third) / 1e-9 / pace.dddq_max);
    }
  }

  void WatchPlaces(const model::VecN& q, PlanResidual& residual) const {
    for (int i = 0; i < q.size(); ++i) {
      const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
      const double margin = config_.guard.joint_position_margin;
      residual.solid = std::min({residual.solid, q[i] - joint.q_min - margin, joint.q_max - margin - q[i]});
    }
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, poses);
    for (int i = 0; i < solid_.size(); ++i) {
      residual.solid = std::min(residual.solid, solid_.ValueOf(i, poses, bodies) - solid_.StopMarginOf(i));
    }
    const model::Pose X_BC = poses.X_BE * config_.X_EC;
    const features::TargetOutline outline = config_.feature.Outline();
    residual.sight = std::min(
        residual.sight,
        barriers::ClearanceOfSight({poses, bodies, X_BC, outline, request_.X_BO, config_.guard.obstacles}) -
            config_.guard.sight_clearance);
    const double least = std::min(config_.guard.view.disc_cosine_min, TiltAt(request_.start.q));
    residual.tilt = std::min(residual.tilt, TiltAt(q) - least);
    if (config_.feature.SeesOrientation()) {
      constexpr double kDetected = 0.35;  // the planner's own bound; a start may have less
      residual.facing =
          std::min(residual.facing, FacingAt(q) - std::min(kDetected, FacingAt(request_.start.q)));
      constexpr double kCornerDeg = 16.0;
      residual.corner_deg =
          std::min(residual.corner_deg, CornerDegAt(q) - std::min(kCornerDeg, CornerDegAt(request_.start.q)));
    }
    const vision::Intrinsics camera = BallCamera();
    const config::ViewConfig& view = config_.guard.view;
    for (int i = 0; i < outline.num_points; ++i) {
      const model::Vec3 p = X_BC.Inverse() * (request_.X_BO * outline.p_OP[static_cast<std::size_t>(i)]);
      const double x = p.x() / p.z();
      const double y = p.y() / p.z();
      const double reach = outline.radius / p.z();
      const double room = std::min(
          {x - reach - view.x_min, view.x_max - x - reach, y - reach - view.y_min, view.y_max - y - reach});
      residual.picture_px = std::min(residual.picture_px, p.z() > 0.0 ? room * camera.f_u_px : -HUGE_VAL);
    }
  }

  // The cosine between a disc's normal and the line of sight; 1 for other targets.
  [[nodiscard]] double TiltAt(const model::VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    const model::Vec3 ray = request_.X_BO.p - (poses.X_BE * config_.X_EC).p;
    return request_.normal_B.isZero() ? 1.0 : request_.normal_B.dot(ray) / ray.norm();
  }

  // How far the corner nearest to 0 or 180 degrees is from them, in the picture.
  [[nodiscard]] double CornerDegAt(const model::VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    const model::Pose X_CO = (poses.X_BE * config_.X_EC).Inverse() * request_.X_BO;
    const features::TargetOutline outline = config_.feature.Outline();
    const auto at = [&](int i) {
      const model::Vec3 p = X_CO * outline.p_OP[static_cast<std::size_t>(i % outline.num_points)];
      return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
    };
    double least = 90.0;
    for (int i = 0; i < outline.num_points; ++i) {
      const Eigen::Vector2d a = at(i) - at(i + 1);
      const Eigen::Vector2d b = at(i + 2) - at(i + 1);
      const double angle = std::atan2(std::fabs(a.x() * b.y() - a.y() * b.x()), std::fabs(a.dot(b)));
      least = std::min(least, angle * 180.0 / model::kPi);
    }
    return least;
  }

  // The cosine between a flat target's normal and the line of sight.
  [[nodiscard]] double FacingAt(const model::VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    const model::Vec3 ray = request_.X_BO.p - (poses.X_BE * config_.X_EC).p;
    return request_.X_BO.R.col(2).dot(ray) / ray.norm();
  }

  // One tick of the guard with the plan as its wish. True if a limit acts.
  [[nodiscard]] bool Guard(const trajectory::Reference& at, trajectory::Reference& guarded) const {
    guard::MotionWish wish;
    wish.dq = at.dq;
    wish.ddq = at.ddq;
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, guarded.q, poses);
    model::LinearJacobian J_E_B;
    model::ComputeLinearJacobian(config_.arm, poses, poses.X_BE.p, J_E_B);
    guard::KnownClearances known;
    return guard::GuardMotion(config_, wish, poses.X_BE.p, J_E_B, known, guarded) != 0;
  }

  [[nodiscard]] double FeatureError(const model::VecN& q, int turn) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    features::TargetInCamera seen;
    seen.X_CO = (poses.X_BE * config_.X_EC).Inverse() * request_.X_BO;
    seen.X_CO.R = seen.X_CO.R * features::EqualTurn(turn, features::TraitsOf(config_.feature.target).turns);
    features::FeatureState state;
    return config_.feature.Compute(seen, state) ? (state.s_star - state.s).norm() : HUGE_VAL;
  }

  const config::ServoConfig& config_;
  const trajectory::PlanRequest& request_;
  barriers::SolidBarriers solid_;
};

}  // namespace fovea::test
