// SPDX-License-Identifier: Apache-2.0
// A target's pose: s = (p_CO_C [m], phi [rad]), dim 6, controls all six degrees of freedom, from everywhere.
// Of a target whose orientation is not seen, s = p_CO_C alone, dim 3.
// phi is the turn from the goal's camera D to the camera, R_DC = R_CO_star R_CO^T = exp([phi]x).
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

// Fills the last three entries of a feature, phi, and their rows, at the goal's orientation `R_CO_star`.
// s_star there is 0. Real-time: yes.
void FillTurn(const TargetInCamera& target, const model::Mat3& R_CO_star, FeatureState& state) noexcept;

struct PoseFeature {
  model::Pose X_CO_star{model::Mat3::Identity(), {0.0, 0.0, 0.40}};
  bool has_turn = true;  // phi is part of s

  [[nodiscard]] int Dim() const noexcept { return has_turn ? 6 : 3; }

  // False, with `state` unchanged, if it is refused. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
