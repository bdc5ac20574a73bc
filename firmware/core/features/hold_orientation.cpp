// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/hold_orientation.hpp"

#include "firmware/core/model/rotation.hpp"

namespace fovea::features {

bool HoldOrientation::Compute(const model::Mat3& R_BC, FeatureState& state) const noexcept {
  if (!R_BC.allFinite() || !R_BD.allFinite()) {
    return false;
  }
  const model::Vec3 phi = model::RotationVector(R_BD.transpose().lazyProduct(R_BC));
  state.Resize(kDim);
  state.s = phi;
  state.L_s.rightCols<3>() = model::TurnRateInverse(phi).transpose();
  return true;
}

}  // namespace fovea::features
