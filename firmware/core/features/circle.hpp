// A round target by its centre and its size: s = (f X/Z, f Y/Z, f D/Z), dim 3, controls x, y, z.
//
// The circle's own feature, of the disc's 3-D centre p_CO_C and its diameter D; and the source's simple form
// of a sphere (THEORY B3), to compare with the exact one of sphere.hpp. With f = 1 it has no unit; with the
// focal length [px] it is (s_u, s_v, s_d) [px] of the source, with respect to the principal point, and
//
//         [ -f/Z   0     s_u/Z |  s_u s_v/f      -(f + s_u^2/f)    s_v ]
//   L_s = [  0    -f/Z   s_v/Z |  f + s_v^2/f    -s_u s_v/f       -s_u ]
//         [  0     0     s_d/Z |  s_d s_v/f      -s_d s_u/f        0   ]
//
// The turn about the line of sight, and those across it, are not seen. Refused below Z = kMinDepth.
#pragma once

#include "firmware/core/features/point.hpp"

namespace fovea::features {

struct CircleFeature {
  static constexpr int kDim = 3;

  double diameter = 0.08;                   // D [m]
  double f = 1.0;                           // focal length [px], or 1 for a feature without a unit
  model::Vec3 p_CO_C_star{0.0, 0.0, 0.40};  // where the centre shall be, in C [m]

  // False, with `state` untouched, when the centre is not well before the camera or an argument not finite.
  // Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& target, FeatureState& state) const noexcept;

  // The centre p_CO_C [m] and its covariance [m^2] for a measured `s` [3] and its covariance `cov_s` [3x3].
  // False when s is not finite or names no circle before the camera. Real-time: yes.
  [[nodiscard]] bool Lift(const model::Vec3& s, const model::Mat3& cov_s, model::Vec3& p_CO_C,
                          model::Mat3& cov_p) const noexcept;
};

// The source's estimate of depth, Z = f D / (2 r), for the radius `r_px` in the image of a round thing of
// diameter `D` [m]: exact for a disc that faces the camera squarely; for a sphere on the axis it is too small
// by the factor sqrt(1 - (D / 2Z)^2), 0.5 % at Z = 0.4 m for D = 0.08 m. Real-time: yes.
[[nodiscard]] inline double DepthFromRadius(double f_px, double D, double r_px) noexcept {
  return f_px * D / (2.0 * r_px);
}

}  // namespace fovea::features
