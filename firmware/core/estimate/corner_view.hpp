// SPDX-License-Identifier: Apache-2.0
// A flat target's corners in an image, with the camera's pose, and the corners expected there.
#pragma once

#include <cstdint>

#include "firmware/core/estimate/measurement_doubt.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// Corners in an image, and the camera's pose at its stamp.
struct CornerView {
  std::int64_t stamp_ns = 0;
  double late = 0.0;  // X_CB is the pose this long before the stamp [s]
  // Rolling shutter, as in predict_config.hpp. `seen` is at the stamp if the target stands still in B.
  double row_time = 0.0;
  double row_y = 0.0;
  double late_sigma = 0.0;  // standard deviation of `late` [s]; for a filter that starts
  model::Pose X_CB;
  model::Vec6 V_BC_C = model::Vec6::Zero();  // the camera's twist then [m/s, rad/s]
  features::SeenCorners seen;
  MeasurementDoubt* doubt = nullptr;  // uncertainty of X_CB, for the gate; null: none
};

// d(corners) / d(position, turn), both in axes of B: [2 n x 6].
using CornerSlope =
    Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, 2 * features::Polygon::kMost, 6>;

// The expected corners of O in the normalised image, xy [2 n]. False if one is not in front of the camera.
// Real-time: yes.
[[nodiscard]] bool ExpectCorners(const features::Polygon& polygon, const model::Pose& X_CB,
                                 const model::Pose& X_BO, features::SeenCorners::Vector& xy) noexcept;

// The expected corners of a pose with the covariance `P`: their mean, their slope `H` over the pose's errors,
// and the covariance `bent` (its lower half) that this linear slope does not explain. Sigma points with P's
// own covariance give them (Julier and Uhlmann, Unscented filtering and nonlinear estimation, 2004), because
// near the cylinder through a triangle's corners its poses lie on a fold. False if a corner of one is not in
// front of the camera. Real-time: yes.
[[nodiscard]] bool ExpectAround(const features::Polygon& polygon, const model::Pose& X_CB,
                                const model::Pose& X_BO, const model::Mat6& P,
                                features::SeenCorners::Vector& mean, CornerSlope& H,
                                features::SeenCorners::Covariance& bent) noexcept;

// The derivative of the expected corners; all must be in front of the camera. Real-time: yes.
void SlopeOfCorners(const features::Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                    CornerSlope& H) noexcept;

// The seen corners and their covariance in O's order. O's first corner is seen corner `first`.
// Real-time: yes.
void InOrder(const features::SeenCorners& seen, int first, features::SeenCorners::Vector& xy,
             features::SeenCorners::Covariance& cov) noexcept;

// The index of O's first corner among the seen corners [2 n], for the order nearest to the expected corners.
// Real-time: yes.
[[nodiscard]] int NearestFirst(const features::SeenCorners::Vector& seen,
                               const features::SeenCorners::Vector& expected) noexcept;

}  // namespace fovea::estimate
