// The pose that fits a flat target's corners in some views, taken from different places, all at once.
//
// Not by a filter: beside the cylinder through a triangle's corners its poses lie on a fold, and what a
// filter believed there before the camera moved it does not give up again.
#pragma once

#include <span>

#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

struct PlateView {
  static constexpr double kFirstStep = 0.005;  // how far the camera goes from one view to the next [m]

  model::Pose X_CB;
  features::SeenCorners::Vector xy;
  double variance = 0.0;  // of an entry of one frame's corners
  int frames = 1;         // whose mean this is
};

// How far the camera has gone [m]. Real-time: yes.
[[nodiscard]] inline double WayBetween(const PlateView& a, const PlateView& b) noexcept {
  return (a.X_CB.Inverse().p - b.X_CB.Inverse().p).norm();
}

// Of one frame. Real-time: yes.
[[nodiscard]] PlateView SeePlate(const CornerView& view) noexcept;

// Takes `newest`, of one frame, into the mean of the frames from where the camera stands; begins that anew
// where it has moved. Real-time: yes.
void TakeIntoMean(const PlateView& newest, PlateView& mean) noexcept;

// The squared distances of the corners from where `X_BO` has them, in standard deviations: summed over
// `views` and `newest`; large where one is not before the camera. Real-time: yes.
[[nodiscard]] double MisfitOf(const features::Polygon& polygon, std::span<const PlateView> views,
                              const PlateView& newest, const model::Pose& X_BO) noexcept;

// Improves `X_BO` by `views` and `mean`; by one step of Gauss-Newton, since the pose is near from the view
// before. `X_BO` stays as it was when a corner is not before the camera. Real-time: yes.
void FitPose(const features::Polygon& polygon, std::span<const PlateView> views, const PlateView& mean,
             model::Pose& X_BO) noexcept;

}  // namespace fovea::estimate
