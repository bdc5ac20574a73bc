// SPDX-License-Identifier: Apache-2.0
// A round target by its centre and its size: s = (f X/Z, f Y/Z, f D/Z), dim 3, controls x, y, z.
//
// The feature of a disc with the 3-D centre p_CO_C and the diameter D. It is also the exercises' simple form
// of a sphere (THEORY B3), for comparison with the exact one of sphere.hpp. With f = 1 it has no unit. With
// the focal length [px] it is (s_u, s_v, s_d) [px] of the exercises, relative to the principal point, and
//
//         [ -f/Z   0     s_u/Z |  s_u s_v/f      -(f + s_u^2/f)    s_v ]
//   L_s = [  0    -f/Z   s_v/Z |  f + s_v^2/f    -s_u s_v/f       -s_u ]
//         [  0     0     s_d/Z |  s_d s_v/f      -s_d s_u/f        0   ]
//
// It does not see rotations of the disc about or across the line of sight. Refused below Z = kMinDepth.
#pragma once

#include "firmware/core/features/point.hpp"

namespace fovea::features {

struct CircleFeature {
  static constexpr int kDim = 3;

  double diameter = 0.08;                   // D [m]
  double f = 1.0;                           // focal length [px], or 1 for a feature without a unit
  model::Vec3 p_CO_C_star{0.0, 0.0, 0.40};  // goal of the centre, in C [m]

  // False, with `state` unchanged, if the centre is not clearly in front of the camera or an argument is not
  // finite. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;

  // The centre p_CO_C [m] and its covariance [m^2] for a measured `s` [3] and its covariance `cov_s` [3x3].
  // False if s is not finite or is no circle in front of the camera. Real-time: yes.
  [[nodiscard]] bool Lift(const model::Vec3& s, const model::Mat3& cov_s, model::Vec3& p_CO_C,
                          model::Mat3& cov_p) const noexcept;
};

// The exercises' estimate of depth, Z = f D / (2 r), from the image radius `r_px` of a round object with the
// diameter `D` [m]. It is exact for a disc that faces the camera squarely. For a sphere on the axis it is too
// small by the factor sqrt(1 - (D / 2Z)^2), 0.5 % at Z = 0.4 m for D = 0.08 m. Real-time: yes.
[[nodiscard]] inline double DepthFromRadius(double f_px, double D, double r_px) noexcept {
  return f_px * D / (2.0 * r_px);
}

}  // namespace fovea::features
