// A flat target's corners in an image, with where the camera was, and what is expected of them.
#pragma once

#include <cstdint>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// Corners in an image, and the camera's pose at its stamp.
struct CornerView {
  std::int64_t stamp_ns = 0;
  model::Pose X_CB;
  features::SeenCorners seen;
  model::Mat6 doubt = model::Mat6::Zero();  // of the camera's pose, for the gate: measurement_doubt.hpp
};

// d(corners) / d(position, turn), both in axes of B: [2 n x 6].
using CornerSlope =
    Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, 2 * features::Polygon::kMost, 6>;

// Where O's corners are expected in the normalised image, xy [2 n]. False when one is not before the camera.
// Real-time: yes.
[[nodiscard]] bool ExpectCorners(const features::Polygon& polygon, const model::Pose& X_CB,
                                 const model::Pose& X_BO, features::SeenCorners::Vector& xy) noexcept;

// By how much they move with the target; they must be before the camera. Real-time: yes.
void SlopeOfCorners(const features::Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                    CornerSlope& H) noexcept;

// The seen corners and their covariance in O's order, whose first is the `first` of them. Real-time: yes.
void InOrder(const features::SeenCorners& seen, int first, features::SeenCorners::Vector& xy,
             features::SeenCorners::Covariance& cov) noexcept;

// Which of the seen corners [2 n] O's first is, so that all are nearest to where they are expected.
// Real-time: yes.
[[nodiscard]] int NearestFirst(const features::SeenCorners::Vector& seen,
                               const features::SeenCorners::Vector& expected) noexcept;

}  // namespace fovea::estimate
