// Which of the two poses that a disc's outline allows is the true one.
//
// Seen along the ray r, a disc of normal n looks as one of about 2 (n.r) r - n does, and their centres lie
// some mm apart. But the camera moves, and in the base frame the normal of a disc that does not turn is one
// and the same from everywhere, while the other turns by twice what the ray does. So of all normals the one
// is believed to which some view's pose is nearest in every view.
#pragma once

#include <array>

#include "firmware/core/model/types.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::estimate {

struct DiscChoice {
  static constexpr int kMost = 12;
  struct View {
    std::array<model::Vec3, 2> normal_B{model::Vec3::UnitZ(), model::Vec3::UnitZ()};
    model::Vec3 ray_B = model::Vec3::UnitZ();  // from the camera to the disc
    double weight = 0.0;                       // 1 / variance of a normal [1/rad^2]
  };

  bool started = false;
  model::Vec3 normal_B = model::Vec3::UnitZ();  // that is believed
  int count = 0;
  double step =
      0.02;  // by how much the ray turns from one view to the next [rad]; doubles when they are too many
  std::array<View, kMost> views;
};

// Takes in a measurement of a circle with both its poses, seen from a camera at `X_BC`, and says which of
// them to take, 0 or 1. `changed`: it is of another normal than was believed before. The first view's first
// pose is believed until the others say otherwise. Real-time: yes.
[[nodiscard]] int ChooseDisc(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                             DiscChoice& choice, bool& changed) noexcept;

}  // namespace fovea::estimate
