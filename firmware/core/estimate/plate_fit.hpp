// SPDX-License-Identifier: Apache-2.0
// Fits one pose to a flat target's corners in several views, taken from different places, all at once.
//
// This is not a filter. Near the cylinder through a triangle's corners its poses lie on a fold. A filter
// would keep a wrong pose from there even after the camera has moved.
#pragma once

#include <span>

#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

struct PlateView {
  static constexpr double kFirstStep = 0.005;  // travel of the camera between two kept views [m]

  model::Pose X_CB;
  features::SeenCorners::Vector xy;
  double variance = 0.0;                     // of an entry of one frame's corners
  int frames = 1;                            // number of frames in this mean
  double late = 0.0;                         // X_CB is the pose this long before the frame's stamp [s]
  model::Vec6 V_BC_C = model::Vec6::Zero();  // the camera's twist then [m/s, rad/s]
};

// The travel of the camera between two views [m]. Real-time: yes.
[[nodiscard]] inline double WayBetween(const PlateView& a, const PlateView& b) noexcept {
  return (a.X_CB.Inverse().p - b.X_CB.Inverse().p).norm();
}

// The view of one frame. Real-time: yes.
[[nodiscard]] PlateView SeePlate(const CornerView& view) noexcept;

// Moves the camera of `view` to where it was if the frame is `late` [s] older than its stamp: the servo finds
// that only as the camera moves, and by then has views. Real-time: yes.
void MoveToAge(double late, PlateView& view) noexcept;

// Adds `newest`, a single frame, to the mean of the frames from the camera's present place. If the camera
// trembles, the mean is first moved to where a target at `X_BO` would be seen now. Without this, the arm
// would follow the noise of single frames, and so tremble on. Restarts the mean if the camera has moved
// further, or at all if the pose is not sure (`X_BO` null). Real-time: yes.
void TakeIntoMean(const features::Polygon& polygon, const PlateView& newest, const model::Pose* X_BO,
                  PlateView& mean) noexcept;

// The squared distances of the corners from their places at `X_BO`, in standard deviations, summed over
// `views` and `newest`. Large if a corner is not in front of the camera. Real-time: yes.
[[nodiscard]] double MisfitOf(const features::Polygon& polygon, std::span<const PlateView> views,
                              const PlateView& newest, const model::Pose& X_BO) noexcept;

// One Gauss-Newton step of a pose to several views, view by view. One step suffices, because the views before
// left the pose close. The frames' age, which is the same for all views and not exactly known, is a seventh
// unknown: if it is wrong, views of a camera in motion are off in the direction of that motion, and must not
// pull the pose. Real-time: yes.
class PlateFit {
 public:
  // Adds a view. `X_BO`: the same pose for all of them.
  void Add(const features::Polygon& polygon, const PlateView& view, const model::Pose& X_BO) noexcept;
  // Improves `X_BO`. It stays unchanged if a corner of a view was not in front of the camera. `late_sigma`:
  // standard deviation of the frames' age [s].
  void Improve(double late_sigma, model::Pose& X_BO) const noexcept;

  // Calls `visit` for each of the sums.
  template <class Self, class Visit>
  static void Sums(Self& self, const Visit& visit) noexcept {
    visit(self.information_);
    visit(self.right_);
    visit(self.is_possible_);
  }

 private:
  static constexpr int kLate = 6;  // after position and turn

  // Of the normal equations.
  Eigen::Matrix<double, 7, 7> information_ = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> right_ = Eigen::Matrix<double, 7, 1>::Zero();
  bool is_possible_ = true;
};

}  // namespace fovea::estimate
