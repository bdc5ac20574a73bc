// SPDX-License-Identifier: Apache-2.0
// Kalman filter of a flat target's pose and its motion in the base frame, from its corners in the image.
//
// White jerk disturbs the position, as in target_filter.hpp. The orientation's error has three coordinates,
// R_true = exp([delta]x) R, and white angular acceleration disturbs it:
//
//   R(t + dt) = exp([w dt]x) R(t),   delta' = exp([w dt]x) delta + A(w dt) dt dw,   A of rotation.hpp
//
// (Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control, 2014, chapter 6.)
//
// The filter uses the corners themselves, not a pose, because a pose's errors in position and tilt are
// correlated. Where the camera passes the cylinder through a triangle's corners, two of the poses that fit
// merge and vanish, but the corners keep all their information.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

// Noise of the camera's own pose from one view to the next, from the encoders and the bending of the arm:
// standard deviations along and about each axis. It moves all corners together.
inline constexpr double kCameraShiftSigma = 5e-5;  // [m]
inline constexpr double kCameraTurnSigma = 5e-5;   // [rad]

// Estimate at `stamp_ns`, the stamp of the last accepted view.
struct PoseFilter {
  static constexpr int kDim = 16;
  // First index of each part of the error, three entries each, all in axes of B.
  static constexpr int kPosition = 0;      // [m]
  static constexpr int kTurn = 3;          // delta [rad]
  static constexpr int kVelocity = 6;      // [m/s]
  static constexpr int kAcceleration = 9;  // [m/s^2]
  static constexpr int kTurnRate = 12;     // dw [rad/s]
  static constexpr int kLate = 15;         // of `late` [s]

  std::int64_t stamp_ns = 0;
  model::Pose X_BO;
  model::Vec3 v_BO_B = model::Vec3::Zero();
  model::Vec3 a_BO_B = model::Vec3::Zero();
  model::Vec3 w_BO_B = model::Vec3::Zero();
  double late = 0.0;  // the views are this much older than their stamps [s]
  Eigen::Matrix<double, kDim, kDim> P = Eigen::Matrix<double, kDim, kDim>::Zero();
};

// Starts at the view's pose nearest to `branch`. False, with `filter` unchanged, if there is none.
// Real-time: yes.
[[nodiscard]] bool StartPose(const features::Polygon& polygon, const CornerView& view,
                             const features::SeenCorners::Branch& branch, PoseFilter& filter) noexcept;

// Updates the filter with a view later than its stamp. The expected corners determine which seen corner is
// O's first. False, with `filter` unchanged, if the view is further off than the gate and the view's doubt
// allow. The target's motion stays within the configured bounds. `distance2`: the squared innovation in
// standard deviations; large if there is none. Real-time: yes.
[[nodiscard]] bool UpdatePose(const config::PredictConfig& config, const features::Polygon& polygon,
                              const CornerView& view, PoseFilter& filter, double& distance2) noexcept;

// The target's pose and motion at `now_ns`. Real-time: yes.
struct FlatMotion {
  model::Pose X_BO;
  model::Vec3 v_BO_B = model::Vec3::Zero();  // [m/s]
  model::Vec3 w_BO_B = model::Vec3::Zero();  // [rad/s]
};
[[nodiscard]] FlatMotion MotionAt(const config::PredictConfig& config, const PoseFilter& filter,
                                  std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
