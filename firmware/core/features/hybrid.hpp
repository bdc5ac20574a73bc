// SPDX-License-Identifier: Apache-2.0
// The hybrid feature: s = (x, y, ln Z, phi), dim 6. x, y [normalised image] and Z [m] are those of the
// target's origin, phi [rad] is the turn of pose.hpp. Of a target whose orientation is not seen, s = (x, y,
// ln Z), dim 3.
//
// With d p_C/dt = -v - w x p_C + (the origin's own velocity), x and y as in point.hpp:
//
//   d(ln Z)/dt = [ 0  0  -1/Z | -y  x  0 ] V_BC_C + (the origin's own velocity along z) / Z
//
// L_s is block triangular and regular wherever Z > 0 and phi is less than a whole turn, so there is no local
// minimum, and the origin's path in the image is straight. (Malis, Chaumette, Boudet, 2-1/2-D visual
// servoing, 1999.) Refused below Z = kMinDepth; valid up to half a turn.
#pragma once

#include "firmware/core/features/point.hpp"

namespace fovea::features {

struct HybridFeature {
  model::Pose X_CO_star{model::Mat3::Identity(), {0.0, 0.0, 0.40}};
  bool has_turn = true;  // phi is part of s

  [[nodiscard]] int Dim() const noexcept { return has_turn ? 6 : 3; }

  // False, with `state` unchanged, if it is refused. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;
};

}  // namespace fovea::features
