// SPDX-License-Identifier: Apache-2.0
// Holds the camera's orientation: s = phi, the turn from the goal's orientation D to the camera's, R_DC =
// exp([phi]x) [rad], dim 3, controls the three turns. Stacked below a sphere or a circle, which see no
// orientation.
//
// With w the camera's angular velocity in axes of C: dphi/dt = A(phi)^-T w, A of rotation.hpp, so that L_s =
// [ 0 | A(phi)^-T ]. The target's motion does not enter. Valid up to half a turn.
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::features {

struct HoldOrientation {
  static constexpr int kDim = 3;

  model::Mat3 R_BD = model::Mat3::Identity();  // the orientation to hold

  // False, with `state` unchanged, if `R_BC` or `R_BD` is not finite. Real-time: yes.
  [[nodiscard]] bool Compute(const model::Mat3& R_BC, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
