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

void TargetHand::Drag(const Eigen::Isometry3d& X_BO, const Eigen::Isometry3d& wish, std::int64_t now_ns) {
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

std::optional<Eigen::Isometry3d> TargetHand::At(std::int64_t now_ns) const {
  if (motion_ == Motion::kNone) {
    return std::nullopt;
  }
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  if (motion_ == Motion::kDragged) {
    const double share =
        std::clamp(static_cast<double>(now_ns - from_ns_) / static_cast<double>(kGlideNs), 0.0, 1.0);
    const Eigen::Quaterniond from(from_.linear());
    X_BO.linear() = from.slerp(share, Eigen::Quaterniond(to_.linear())).toRotationMatrix();
    X_BO.translation() = (1.0 - share) * from_.translation() + share * to_.translation();
  } else {
    // The integral of a speed that decays like exp(-t / kSlowdownS).
    const double t_s = static_cast<double>(now_ns - from_ns_) * 1e-9;
    const double way_s = kSlowdownS * -std::expm1(-t_s / kSlowdownS);
    const Eigen::Vector3d turn = omega_B_ * way_s;
    const double angle = turn.norm();
    X_BO.linear() = from_.linear();
    if (angle > 0.0) {
      X_BO.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * from_.linear();
    }
    X_BO.translation() = from_.translation() + v_BO_ * way_s;
  }
  X_BO.translation().z() = std::max(X_BO.translation().z(), least_height_);
  return X_BO;
}

}  // namespace fovea::sim
