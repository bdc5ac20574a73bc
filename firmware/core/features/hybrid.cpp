// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/hybrid.hpp"

#include "firmware/core/features/pose.hpp"
#include "firmware/core/model/log.hpp"

namespace fovea::features {

bool HybridFeature::Compute(const TargetInCamera& target, FeatureState& state) const noexcept {
  ImagePoint origin;
  const model::Vec3& p_star = X_CO_star.p;
  if (!target.IsFinite() || !(p_star.z() >= kMinDepth) ||
      !ComputePoint(target.X_CO.p, target.v_BO_C, origin)) {
    return false;
  }
  const double Z = target.X_CO.p.z();
  state.Resize(Dim());
  state.s.head<2>() = origin.xy;
  state.s[2] = model::Log(Z);
  state.s_star.head<3>() << p_star.x() / p_star.z(), p_star.y() / p_star.z(), model::Log(p_star.z());
  state.ds_dt_target.head<2>() = origin.dxy_dt_target;
  state.ds_dt_target[2] = target.v_BO_C.z() / Z;
  state.L_s.topRows<2>() = origin.L;
  state.L_s.row(2) << 0.0, 0.0, -1.0 / Z, -origin.xy.y(), origin.xy.x(), 0.0;
  if (has_turn) {
    FillTurn(target, X_CO_star.R, state);
  }
  return true;
}

}  // namespace fovea::features
