// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/point.hpp"

namespace fovea::features {

bool ComputePoint(const model::Vec3& p_C, const model::Vec3& v_BP_C, ImagePoint& point) noexcept {
  if (!(p_C.z() >= kMinDepth) || !p_C.allFinite() || !v_BP_C.allFinite()) {
    return false;
  }
  const double near = 1.0 / p_C.z();
  const double x = p_C.x() * near;
  const double y = p_C.y() * near;
  point.xy = {x, y};
  point.dxy_dt_target = {near * (v_BP_C.x() - x * v_BP_C.z()), near * (v_BP_C.y() - y * v_BP_C.z())};
  point.L << -near, 0.0, x * near, x * y, -(1.0 + x * x), y,  //
      0.0, -near, y * near, 1.0 + y * y, -x * y, -x;
  return true;
}

bool ComputePoint(const TargetInCamera& target, const model::Vec3& p_OP, ImagePoint& point) noexcept {
  const model::Vec3 arm = target.X_CO.R.lazyProduct(p_OP);
  return ComputePoint(target.X_CO.p + arm, target.v_BO_C + model::Cross(target.w_BO_C, arm), point);
}

}  // namespace fovea::features
