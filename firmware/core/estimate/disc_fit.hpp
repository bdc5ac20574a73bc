// The normal that fits a disc's outline in some views, taken from different places, all at once.
//
// Seen along the ray r, a disc of normal n looks as one of about 2 (n.r) r - n does, and their centres lie
// some mm apart. In the base frame the normal of a disc that does not turn is one and the same from
// everywhere, while the other turns by twice what the ray does. So the true normal is one to which some pose
// of every view is near.
#pragma once

#include <array>
#include <span>

#include "firmware/core/model/types.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::estimate {

struct DiscView {
  static constexpr double kFirstStep = 0.02;  // by how much the ray turns from one view to the next [rad]

  std::array<model::Vec3, 2> normal_B{model::Vec3::UnitZ(), model::Vec3::UnitZ()};
  model::Vec3 ray_B = model::Vec3::UnitZ();  // from the camera to the disc
  double weight = 0.0;                       // 1 / variance of a normal [1/rad^2]
};

// By how much the ray has turned [rad]. Real-time: yes.
[[nodiscard]] inline double WayBetween(const DiscView& a, const DiscView& b) noexcept {
  return (a.ray_B - b.ray_B).norm();
}

// A measurement of a circle with both its poses, by a camera at `X_BC`. False when one of them is none.
// Real-time: yes.
[[nodiscard]] bool SeeDisc(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                           DiscView& view) noexcept;

// Which of a view's normals is nearer to `normal`. Real-time: yes.
[[nodiscard]] inline int Nearer(const DiscView& view, const model::Vec3& normal) noexcept {
  return view.normal_B[0].dot(normal) >= view.normal_B[1].dot(normal) ? 0 : 1;
}

// Improves `normal` by what `views` and `newest` say. How badly it then fits them: the squared turns in
// standard deviations. Real-time: yes.
[[nodiscard]] double FitNormal(std::span<const DiscView> views, const DiscView& newest,
                               model::Vec3& normal) noexcept;

}  // namespace fovea::estimate
