// The camera's orientation held: s = phi, the turn from the goal's orientation D to the camera's,
// R_DC = exp([phi]x) [rad], dim 3, controls the three turns. To be stacked with what sees no orientation,
// a sphere or a circle.
//
// With w the camera's angular velocity in axes of C: dphi/dt = A(phi)^-T w, A of rotation.hpp, so that
// L_s = [ 0 | A(phi)^-T ]. The target has no share in it. Good up to half a turn.
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::features {

struct HoldOrientation {
  static constexpr int kDim = 3;

  model::Mat3 R_BD = model::Mat3::Identity();  // what is held

  // False, with `state` untouched, when `R_BC` is not finite. Real-time: yes.
  [[nodiscard]] bool Compute(const model::Mat3& R_BC, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
