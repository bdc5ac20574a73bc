// SPDX-License-Identifier: Apache-2.0
// A visual feature at one instant: the input of the visual law, for every target.
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::features {

inline constexpr int kMaxDim = hal::kMaxFeatureDim;

using FeatureVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxDim, 1>;
using InteractionMatrix = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxDim, 6>;

struct FeatureState {
  FeatureVector s;             // [dim]
  FeatureVector s_star;        // [dim] goal
  FeatureVector ds_dt_target;  // [dim] ds/dt from the target's own motion [1/s]
  InteractionMatrix L_s;       // [dim x 6] ds/dt = L_s V_BC_C for a target at rest

  void Resize(int dim) noexcept {
    s.setZero(dim);
    s_star.setZero(dim);
    ds_dt_target.setZero(dim);
    L_s.setZero(dim, 6);
  }
};

// A target's pose and motion as the camera sees them. For a sphere only the position counts.
struct TargetInCamera {
  model::Pose X_CO;                          // [m]
  model::Vec3 v_BO_C = model::Vec3::Zero();  // velocity of O's origin in B, in axes of C [m/s]
  model::Vec3 w_BO_C = model::Vec3::Zero();  // angular velocity of O in B, in axes of C [rad/s]

  [[nodiscard]] bool IsFinite() const noexcept {
    return X_CO.p.allFinite() && X_CO.R.allFinite() && v_BO_C.allFinite() && w_BO_C.allFinite();
  }
};

// Stacks `part`'s entries below those of `whole`. False, with `whole` unchanged, if there is no room.
// Real-time: yes.
[[nodiscard]] inline bool Stack(const FeatureState& part, FeatureState& whole) noexcept {
  const Eigen::Index above = whole.s.size();
  const Eigen::Index below = part.s.size();
  if (above + below > kMaxDim) {
    return false;
  }
  const FeatureState before = whole;
  whole.Resize(static_cast<int>(above + below));
  whole.s.head(above) = before.s;
  whole.s_star.head(above) = before.s_star;
  whole.ds_dt_target.head(above) = before.ds_dt_target;
  whole.L_s.topRows(above) = before.L_s;
  whole.s.tail(below) = part.s;
  whole.s_star.tail(below) = part.s_star;
  whole.ds_dt_target.tail(below) = part.ds_dt_target;
  whole.L_s.bottomRows(below) = part.L_s;
  return true;
}

}  // namespace fovea::features
