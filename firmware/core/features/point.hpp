// SPDX-License-Identifier: Apache-2.0
// One point of a target in the normalised image: (x, y) = (X/Z, Y/Z), dim 2. The flat targets' features
// consist of such points.
//
// With d p_C/dt = -v - w x p_C + (the point's own velocity), and x, y of p_C:
//
//   L = [ -1/Z    0    x/Z |  x y      -(1 + x^2)    y ]
//       [   0   -1/Z   y/Z |  1 + y^2   -x y        -x ]
//
// (Chaumette and Hutchinson, Visual servo control I, 2006, eq. 10.) Times f, in pixels, it is THEORY B3.
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::features {

inline constexpr double kMinDepth = 0.01;  // a point with a smaller Z is refused [m]

using Vec2 = Eigen::Matrix<double, 2, 1>;
using Mat26 = Eigen::Matrix<double, 2, 6>;

struct ImagePoint {
  Vec2 xy;             // normalised
  Vec2 dxy_dt_target;  // from the point's own motion [1/s]
  Mat26 L;             // d(xy)/dt = L V_BC_C for a point at rest
};

// The point at `p_C` [m] that moves with `v_BP_C` [m/s] in B, both in axes of C. False, with `point`
// unchanged, if Z is below kMinDepth or an argument is not finite. Real-time: yes.
[[nodiscard]] bool ComputePoint(const model::Vec3& p_C, const model::Vec3& v_BP_C,
                                ImagePoint& point) noexcept;

// The same for the point at `p_OP` [m] of a target. Real-time: yes.
[[nodiscard]] bool ComputePoint(const TargetInCamera& target, const model::Vec3& p_OP,
                                ImagePoint& point) noexcept;

}  // namespace fovea::features
