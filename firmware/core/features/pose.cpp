// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/pose.hpp"

#include "firmware/core/model/rotation.hpp"

namespace fovea::features {

void FillTurn(const TargetInCamera& target, const model::Mat3& R_CO_star, FeatureState& state) noexcept {
  const model::Vec3 phi = model::RotationVector(R_CO_star.lazyProduct(target.X_CO.R.transpose()));
  const model::Mat3 rate = model::TurnRateInverse(phi).transpose();
  state.s.tail<3>() = phi;
  state.ds_dt_target.tail<3>() = -rate * target.w_BO_C;
  state.L_s.bottomRightCorner<3, 3>() = rate;
}

bool PoseFeature::Compute(const TargetInCamera& target, FeatureState& state) const noexcept {
  if (!target.IsFinite() || !(target.X_CO.p.z() >= kMinDepth)) {
    return false;
  }
  state.Resize(Dim());
  state.s.head<3>() = target.X_CO.p;
  state.s_star.head<3>() = X_CO_star.p;
  state.ds_dt_target.head<3>() = target.v_BO_C;
  state.L_s.topLeftCorner<3, 3>() = -model::Mat3::Identity();
  state.L_s.topRightCorner<3, 3>() = model::CrossMatrix(target.X_CO.p);
  if (has_turn) {
    FillTurn(target, X_CO_star.R, state);
  }
  return true;
}

}  // namespace fovea::features
