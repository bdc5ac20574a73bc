// Where a flat target would be if it stood still: the pose that fits its corners in some views, taken from
// different places, all at once.
//
// Not by a filter: beside the cylinder through a triangle's corners its poses lie on a fold, and what a
// filter believed there before the camera moved it does not give up again.
#pragma once

#include <array>

#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

// Views spread over the camera's way, however long that gets.
struct StillViews {
  static constexpr int kMost = 16;
  struct View {
    model::Pose X_CB;
    features::SeenCorners::Vector xy;
    double variance = 0.0;  // of an entry of one frame's corners
    int frames = 1;         // whose mean this is
  };

  int count = 0;
  double step = 0.005;  // how far the camera goes from one to the next [m]; doubles when they are too many
  std::array<View, kMost> views;
  View here;  // the mean of the frames since the camera stands where it is
};

// Takes the view when the camera has gone far enough since the last one, and into the mean of those from
// where it stands. Real-time: yes.
void AddView(const CornerView& view, StillViews& views) noexcept;

// The squared distances of the corners from where `X_BO` has them, in standard deviations: summed over the
// `count` views and `newest`, each of one frame; large where one is not before the camera. Real-time: yes.
[[nodiscard]] double MisfitOf(const features::Polygon& polygon, const StillViews& views,
                              const CornerView& newest, const model::Pose& X_BO) noexcept;

// Improves `X_BO` by all views, with the mean from where the camera stands; by one step of Gauss-Newton,
// since the pose is near from the view before. False, and `X_BO` as it was, when a corner is not before the
// camera. Real-time: yes.
bool FitStill(const features::Polygon& polygon, const StillViews& views, model::Pose& X_BO) noexcept;

}  // namespace fovea::estimate
