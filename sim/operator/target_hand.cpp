// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/target_hand.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {
namespace {

Eigen::Vector3d Shortened(const Eigen::Vector3d& v, double most) {
  const double norm = v.norm();
  return norm > most ? Eigen::Vector3d(v * (most / norm)) : v;
}

}  // namespace

double TargetHand::SecondsSince(std::int64_t now_ns) const {
  return static_cast<double>(now_ns - from_ns_) * 1e-9;
}

Eigen::Vector3d TargetHand::VelocityAt(std::int64_t now_ns) const {
  const double t_s = SecondsSince(now_ns);
  switch (motion_) {
    case Motion::kNone: break;
    case Motion::kThrown: return v_BO_ * std::exp(-t_s / kSlowdownS);
    case Motion::kDragged: {
      const Eigen::Vector3d off = from_.translation() - to_.translation();
      const Eigen::Vector3d slope = v_BO_ + kFollowRate * off;
      return (v_BO_ - kFollowRate * t_s * slope) * std::exp(-kFollowRate * t_s);
    }
  }
  return Eigen::Vector3d::Zero();
}

void TargetHand::Drag(const Eigen::Isometry3d& X_BO, const Eigen::Isometry3d& wish, std::int64_t now_ns) {
  v_BO_ = VelocityAt(now_ns);
  motion_ = Motion::kDragged;
  held_ = true;
  from_ns_ = now_ns;
  from_ = X_BO;
  to_ = wish;
}

void TargetHand::Throw(const Eigen::Isometry3d& X_BO, const Eigen::Vector3d& v_BO,
                       const Eigen::Vector3d& omega_B, std::int64_t now_ns) {
  motion_ = Motion::kThrown;
  held_ = false;
  from_ns_ = now_ns;
  from_ = X_BO;
  v_BO_ = Shortened(v_BO, kMostSpeed);
  omega_B_ = Shortened(omega_B, kMostTurnRate);
}

Eigen::Isometry3d TargetHand::AboveTable(Eigen::Isometry3d X_BO) const {
  X_BO.translation().z() = std::max(X_BO.translation().z(), least_height_);
  return X_BO;
}

std::optional<Eigen::Isometry3d> TargetHand::Goal() const {
  return motion_ == Motion::kDragged ? std::optional(AboveTable(to_)) : std::nullopt;
}

std::optional<Eigen::Isometry3d> TargetHand::At(std::int64_t now_ns) const {
  if (motion_ == Motion::kNone) {
    return std::nullopt;
  }
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  if (motion_ == Motion::kDragged) {
    const double t_s = SecondsSince(now_ns);
    const double fade = std::exp(-kFollowRate * t_s);
    const Eigen::Vector3d off = from_.translation() - to_.translation();
    X_BO.translation() = to_.translation() + fade * (off + t_s * (v_BO_ + kFollowRate * off));
    const Eigen::Quaterniond from(from_.linear());
    const double share = 1.0 - fade * (1.0 + kFollowRate * t_s);
    X_BO.linear() = from.slerp(share, Eigen::Quaterniond(to_.linear())).toRotationMatrix();
  } else {
    // The integral of a speed that decays like exp(-t / kSlowdownS).
    const double t_s = SecondsSince(now_ns);
    const double way_s = kSlowdownS * -std::expm1(-t_s / kSlowdownS);
    const Eigen::Vector3d turn = omega_B_ * way_s;
    const double angle = turn.norm();
    X_BO.linear() = from_.linear();
    if (angle > 0.0) {
      X_BO.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * from_.linear();
    }
    X_BO.translation() = from_.translation() + v_BO_ * way_s;
  }
  return AboveTable(X_BO);
}

}  // namespace fovea::sim
