// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/sphere.hpp"

#include <cmath>

namespace fovea::features {
namespace {

bool IsBeforeCamera(const model::Vec3& s) noexcept {
  return s.allFinite() && s.z() > 0.0 &&
         s.squaredNorm() > SphereFeature::kMinDistance * SphereFeature::kMinDistance;
}

}  // namespace

bool SphereFeature::Compute(const model::Vec3& p_CO_C, const model::Vec3& v_BO_C,
                            FeatureState& state) const noexcept {
  const model::Vec3 s = p_CO_C / radius;
  if (!IsBeforeCamera(s) || !v_BO_C.allFinite()) {
    return false;
  }
  state.s = s;
  state.s_star = p_CO_C_star / radius;
  state.ds_dt_target = v_BO_C / radius;
  state.L_s.resize(kDim, 6);
  state.L_s.leftCols<3>() = model::Mat3::Identity() * (-1.0 / radius);
  state.L_s.rightCols<3>() = model::CrossMatrix(s);
  return true;
}

bool SphereFeature::Lift(const model::Vec3& s, const model::Mat3& cov_s, model::Vec3& p_CO_C,
                         model::Mat3& cov_p) const noexcept {
  if (!IsBeforeCamera(s) || !cov_s.allFinite()) {
    return false;
  }
  p_CO_C = s * radius;
  cov_p = cov_s * (radius * radius);
  return true;
}

bool SphereFromCone(const model::Vec3& m, model::Vec3& s, model::Mat3& ds_dm) noexcept {
  const double k = m.squaredNorm() - 1.0;
  if (!(k > 0.0)) {
    return false;
  }
  const double root = std::sqrt(k);
  const model::Vec3 candidate = m / root;
  if (!IsBeforeCamera(candidate)) {
    return false;
  }
  s = candidate;
  ds_dm = model::Mat3::Identity() / root - m * m.transpose() / (k * root);
  return true;
}

model::Vec3 ConeFromSphere(const model::Vec3& s) noexcept { return s / std::sqrt(s.squaredNorm() - 1.0); }

}  // namespace fovea::features
