// SPDX-License-Identifier: Apache-2.0
// A target's whole pose: s = (p_CO_C [m], phi [rad]), dim 6, controls all six degrees of freedom, from
// everywhere. phi is the turn from the goal's camera D to the camera, R_DC = R_CO_star R_CO^T = exp([phi]x).
//
//         [ -I   [p]x    ]
//   L_s = [  0   A^-T(phi) ],   A of rotation.hpp;  ds/dt of the target (v, w):  (v, -A^-T w)
//
// (Chaumette and Hutchinson, Visual servo control I, 2006, section on pose-based control.) Three corners look
// the same from up to four poses, and a law on the corners may end at a wrong one. The filter's pose is the
// right one. Refused below Z = kMinDepth; valid up to half a turn.
#pragma once

#include "firmware/core/features/point.hpp"

namespace fovea::features {

struct PoseFeature {
  static constexpr int kDim = 6;

  model::Pose X_CO_star{model::Mat3::Identity(), {0.0, 0.0, 0.40}};

  // False, with `state` unchanged, if it is refused. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
