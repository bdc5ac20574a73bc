// SPDX-License-Identifier: Apache-2.0
// The effect of calibration errors on a measurement: how far the camera's pose, as the measurement sees it,
// may disagree with what the filter absorbed a moment before.
//
// A wrong mount or scale puts the target in a wrong place. While the hand's motion stays the same, so
// does the place, and the filter absorbs the error. It cannot absorb the error's change. With delta the
// mount's error as a twist of C, c the target in C, sigma its relative error in scale, and 1 -> 2 the
// camera's motion since a moment before:
//
//   (I - Ad(X_C2C1)) delta,   (c - R_C2C1 c_1) sigma
//
// A wrong focal length f (1 + sigma) makes a target of known size nearer and moves its line of sight, by
//
//   f(c) = (0, 0, -z) sigma,   phi(c) = (-y, x, 0) sigma / (1 + x^2 + y^2),   c = z (x, y, 1)
//
// and what the filter cannot absorb is f(c) - R_C2C1 f(c_1), and the same of phi. A hand that turns by half a
// radian in a moment moves the target by 5 px if f is wrong by 2 %.
//
// Only the gate uses the sum of their covariances (a consider covariance: Schmidt, Application of state-space
// methods to navigation problems, 1966). The gain ignores it, because averaging does not remove these errors.
// A wrong stamp is a state of the filters (stamp_error.hpp).
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/joint_history.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::estimate {

// Computed when it is first asked for: most measurements pass the gate without it.
class MeasurementDoubt {
 public:
  // For a measurement at `stamp_ns` of a target at `p_CO_C` [m], when the camera was at `X_BC`. `config` and
  // `history` must outlive the object.
  MeasurementDoubt(const config::ServoConfig& config, const JointHistory& history, std::int64_t stamp_ns,
                   const model::Pose& X_BC, const model::Vec3& p_CO_C) noexcept
      : config_(config), history_(history), stamp_ns_(stamp_ns), X_BC_(X_BC), p_CO_C_(p_CO_C) {}

  // Covariance of the camera's pose as a twist of C, [v; w] [m, rad]. Zero if the history does not reach
  // back. Real-time: yes.
  [[nodiscard]] const model::Mat6& OfCamera() noexcept;
  // The covariance that it gives a target at `p_CO_C`, in axes of B [m^2]. Real-time: yes.
  [[nodiscard]] model::Mat3 OfPlace(const model::Vec3& p_CO_C) noexcept;

 private:
  [[nodiscard]] model::Mat6 Compute() const noexcept;

  const config::ServoConfig& config_;
  const JointHistory& history_;
  std::int64_t stamp_ns_;
  model::Pose X_BC_;
  model::Vec3 p_CO_C_;
  std::optional<model::Mat6> cov_;
};

// How the camera's twist [v; w] moves a target at `p_CO_C`, seen from B in axes of C: v + w x p_CO_C.
using PlaceSlope = Eigen::Matrix<double, 3, 6>;
[[nodiscard]] PlaceSlope PlaceByCamera(const model::Vec3& p_CO_C) noexcept;

}  // namespace fovea::estimate
