// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/circle.hpp"

namespace fovea::features {

bool CircleFeature::Compute(const TargetInCamera& target, FeatureState& state) const noexcept {
  ImagePoint centre;
  if (!target.IsFinite() || !ComputePoint(target, model::Vec3::Zero(), centre)) {
    return false;
  }
  const double near = 1.0 / target.X_CO.p.z();
  const double size = diameter * near;  // D/Z
  state.Resize(kDim);
  state.s << f * centre.xy, f * size;
  state.s_star = (f / p_CO_C_star.z()) * model::Vec3(p_CO_C_star.x(), p_CO_C_star.y(), diameter);
  state.ds_dt_target << f * centre.dxy_dt_target, -f * size * near * target.v_BO_C.z();
  state.L_s.topRows<2>() = f * centre.L;
  // d(D/Z)/dt = -D/Z^2 dZ/dt, and dZ/dt = -v_z - (w_x Y - w_y X).
  const double scaled = f * size;
  state.L_s.row(2) << 0.0, 0.0, scaled * near, scaled * centre.xy.y(), -scaled * centre.xy.x(), 0.0;
  return true;
}

bool CircleFeature::Lift(const model::Vec3& s, const model::Mat3& cov_s, model::Vec3& p_CO_C,
                         model::Mat3& cov_p) const noexcept {
  if (!s.allFinite() || !cov_s.allFinite() || !(s.z() > 0.0)) {
    return false;
  }
  const double depth = f * diameter / s.z();
  if (!(depth >= kMinDepth)) {
    return false;
  }
  p_CO_C = {s.x() * depth / f, s.y() * depth / f, depth};
  model::Mat3 dp_ds;
  dp_ds << depth / f, 0.0, -p_CO_C.x() / s.z(),  //
      0.0, depth / f, -p_CO_C.y() / s.z(),       //
      0.0, 0.0, -depth / s.z();
  cov_p = dp_ds.lazyProduct(model::Mat3(cov_s.lazyProduct(dp_ds.transpose())));
  return true;
}

}  // namespace fovea::features
