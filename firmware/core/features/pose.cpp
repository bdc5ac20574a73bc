// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/pose.hpp"

#include "firmware/core/model/rotation.hpp"

namespace fovea::features {

bool PoseFeature::Compute(const TargetInCamera& target, FeatureState& state) const noexcept {
  if (!target.IsFinite() || !(target.X_CO.p.z() >= kMinDepth)) {
    return false;
  }
  const model::Vec3 phi = model::RotationVector(X_CO_star.R.lazyProduct(target.X_CO.R.transpose()));
  const model::Mat3 rate = model::TurnRateInverse(phi).transpose();
  state.Resize(kDim);
  state.s << target.X_CO.p, phi;
  state.s_star.head<3>() = X_CO_star.p;
  state.ds_dt_target << target.v_BO_C, -rate * target.w_BO_C;
  state.L_s.topLeftCorner<3, 3>() = -model::Mat3::Identity();
  state.L_s.topRightCorner<3, 3>() = model::CrossMatrix(target.X_CO.p);
  state.L_s.bottomRightCorner<3, 3>() = rate;
  return true;
}

}  // namespace fovea::features
