// SPDX-License-Identifier: Apache-2.0
// Fits one normal of a disc to its outlines in several views, taken from different places, all at once.
//
// Seen along the ray r, a disc with the normal n looks like one with the normal of about 2 (n.r) r - n, whose
// centre is some mm away. In the base frame the true normal of a disc that does not turn is the same in all
// views. The other one turns by twice the ray's angle. So the true normal is near one pose of every view.
#pragma once

#include <array>
#include <span>

#include "firmware/core/model/types.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::estimate {

struct DiscView {
  static constexpr double kFirstStep = 0.02;  // turn of the ray from one kept view to the next [rad]

  std::array<model::Vec3, 2> normal_B{model::Vec3::UnitZ(), model::Vec3::UnitZ()};
  model::Vec3 ray_B = model::Vec3::UnitZ();  // from the camera to the disc
  double weight = 0.0;                       // 1 / variance of a normal [1/rad^2]
};

// The turn of the ray between two views [rad]. Real-time: yes.
[[nodiscard]] inline double WayBetween(const DiscView& a, const DiscView& b) noexcept {
  return (a.ray_B - b.ray_B).norm();
}

// The view of a measured circle with both its poses, by a camera at `X_BC`. False if one pose is invalid.
// Real-time: yes.
[[nodiscard]] bool SeeDisc(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                           DiscView& view) noexcept;

// The index of the view's normal that is nearer to `normal`. Real-time: yes.
[[nodiscard]] inline int Nearer(const DiscView& view, const model::Vec3& normal) noexcept {
  return view.normal_B[0].dot(normal) >= view.normal_B[1].dot(normal) ? 0 : 1;
}

// Improves `normal` with `views` and `newest`. Returns its misfit: the sum of squared angles in standard
// deviations. Real-time: yes.
[[nodiscard]] double FitNormal(std::span<const DiscView> views, const DiscView& newest,
                               model::Vec3& normal) noexcept;

}  // namespace fovea::estimate
