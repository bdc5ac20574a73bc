// Kalman filter of a flat target's pose and its motion in the base frame, from its corners in the image.
//
// The position is disturbed by white jerk, as target_filter.hpp has it; the orientation has its error's own
// three coordinates, R_true = exp([delta]x) R, and is disturbed by white angular acceleration:
//
//   R(t + dt) = exp([w dt]x) R(t),   delta' = exp([w dt]x) delta + A(w dt) dt dw,   A of rotation.hpp
//
// (Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control, 2014, chapter 6.)
//
// The corners are taken in as they are, not as a pose: a pose's errors in position and tilt belong together,
// and where the camera passes the cylinder through a triangle's corners two of the poses that fit them become
// one and vanish, while the corners still say all that they say.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

// How well the camera's own pose is known from one view to the next, by encoders and by how the arm bends:
// standard deviations along and about each axis. It moves all corners together.
inline constexpr double kCameraShiftSigma = 5e-5;  // [m]
inline constexpr double kCameraTurnSigma = 5e-5;   // [rad]

// Estimate at `stamp_ns`, the stamp of the last view that was taken in.
struct PoseFilter {
  static constexpr int kDim = 15;
  // Where the error's parts begin, three entries each, all in axes of B.
  static constexpr int kPosition = 0;      // [m]
  static constexpr int kTurn = 3;          // delta [rad]
  static constexpr int kVelocity = 6;      // [m/s]
  static constexpr int kAcceleration = 9;  // [m/s^2]
  static constexpr int kTurnRate = 12;     // dw [rad/s]

  std::int64_t stamp_ns = 0;
  model::Pose X_BO;
  model::Vec3 v_BO_B = model::Vec3::Zero();
  model::Vec3 a_BO_B = model::Vec3::Zero();
  model::Vec3 w_BO_B = model::Vec3::Zero();
  Eigen::Matrix<double, kDim, kDim> P = Eigen::Matrix<double, kDim, kDim>::Zero();
};

// Starts at the view's pose nearest to `branch`. False, with `filter` untouched, when there is none.
// Real-time: yes.
[[nodiscard]] bool StartPose(const features::Polygon& polygon, const CornerView& view,
                             const features::SeenCorners::Branch& branch, PoseFilter& filter) noexcept;

// Takes in a view later than the filter's stamp; which of the corners is O's first is seen from where they
// are expected. False, with `filter` untouched, when it is further off than the gate and the view's doubt
// allow; the target's motion stays within the configuration's bounds. `distance2`: the squared innovation in
// standard deviations; large where none can be told. Real-time: yes.
[[nodiscard]] bool UpdatePose(const config::PredictConfig& config, const features::Polygon& polygon,
                              const CornerView& view, PoseFilter& filter, double& distance2) noexcept;

// Where the target is at `now_ns`, and how it moves. Real-time: yes.
struct FlatMotion {
  model::Pose X_BO;
  model::Vec3 v_BO_B = model::Vec3::Zero();  // [m/s]
  model::Vec3 w_BO_B = model::Vec3::Zero();  // [rad/s]
};
[[nodiscard]] FlatMotion MotionAt(const config::PredictConfig& config, const PoseFilter& filter,
                                  std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
