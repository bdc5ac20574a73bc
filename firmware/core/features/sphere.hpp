// SPDX-License-Identifier: Apache-2.0
// A sphere of known radius, seen by a calibrated camera: s = p_CO_C / R, dim 3, controls x, y, z.
//
// The sphere's outline is the cone of rays that touch it. With c the unit vector towards the centre and
// sin(theta) = R / |p_CO|, a ray x (z = 1) lies on it when x . m = |x|, m = c / cos(theta): linear in m, so
// an outline in the image gives m by least squares, and m gives s = m / sqrt(|m|^2 - 1). This is exact on and
// off the axis; a circle of radius f R / Z is not.
//
// L_s = [ -1/R I | [s]x ] follows from d p_CO_C / dt = -v - w x p_CO_C (Fomena and Chaumette, Improvements
// on visual servoing from spherical targets using a spherical projection model, 2009).
#pragma once

#include "firmware/core/features/feature_state.hpp"

namespace fovea::features {

struct SphereFeature {
  static constexpr int kDim = 3;
  static constexpr double kMinDistance = 1.05;  // smallest valid distance of the centre, in units of R

  double radius = 0.04;                     // [m]
  model::Vec3 p_CO_C_star{0.0, 0.0, 0.40};  // goal of the centre, in C [m]

  // s, s_star, L_s and the target's share, for a sphere at `p_CO_C` [m] whose centre moves with `v_BO_C`
  // [m/s] in B, both in axes of C. False, with `state` unchanged, if the camera is inside the sphere, the
  // sphere is behind the camera, or an argument is not finite. Real-time: yes.
  [[nodiscard]] bool Compute(const model::Vec3& p_CO_C, const model::Vec3& v_BO_C,
                             FeatureState& state) const noexcept;

  // The centre p_CO_C [m] and its covariance [m^2] for a measured `s` [3] and its covariance `cov_s` [3x3].
  // False if s is not finite or is no sphere in front of the camera. Real-time: yes.
  [[nodiscard]] bool Lift(const model::Vec3& s, const model::Mat3& cov_s, model::Vec3& p_CO_C,
                          model::Mat3& cov_p) const noexcept;
};

// Computes s [3] from the outline's cone, m as above, and ds/dm [3x3] for its covariance. False if |m| <= 1
// (no cone) or the sphere would be behind the camera or around it. Real-time: yes.
[[nodiscard]] bool SphereFromCone(const model::Vec3& m, model::Vec3& s, model::Mat3& ds_dm) noexcept;

// The outline's cone m of a sphere at `s`, |s| > 1. Real-time: yes.
[[nodiscard]] model::Vec3 ConeFromSphere(const model::Vec3& s) noexcept;

}  // namespace fovea::features
