// SPDX-License-Identifier: Apache-2.0
// What a detector saw in one image.
#pragma once

#include <array>
#include <span>

#include "firmware/core/features/feature_state.hpp"
#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/model/types.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::vision {

struct ImagePoint {
  double u_px = 0.0;
  double v_px = 0.0;
};

// The outline of a sphere or disc, or the corners of a polygon, with the feature computed from them.
struct Detection {
  static constexpr int kOutlinePoints = 96;
  static constexpr int kMaxCorners = 4;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, features::kMaxDim,
                                   features::kMaxDim>;

  hal::FeatureKind kind = hal::FeatureKind::kSphere;
  bool found = false;
  bool tracked = false;       // found at the expected place, without a search of the whole image
  double confidence = 0.0;    // 0 to 1
  features::FeatureVector s;  // as hal/feature.hpp defines it for `kind`; empty when not found
  Covariance cov_s;
  // Flat targets: the poses that match the outline, as in hal/feature.hpp. Square and triangle: cov_pose is
  // the covariance of the first pose: position in axes of C [m], small rotation about axes of C [rad].
  struct Pose {
    model::Pose X_CO;
    int first = 0;
  };
  int pose_count = 0;
  std::array<Pose, hal::kMaxPoses> pose;
  model::Mat6 cov_pose = model::Mat6::Zero();

  // The outline, in pixels of a lens without distortion.
  double u_px = 0.0;  // centre of the ellipse, or mean of the corners
  double v_px = 0.0;
  double radius_px = 0.0;                                 // of the circle with the same area as the outline
  Eigen::Matrix3d cov_uvr_px2 = Eigen::Matrix3d::Zero();  // of (u, v, radius) [px^2]
  double rms_px = 0.0;                                    // of the edge points' distances from the outline
  double contrast = 0.0;                                  // mean step across the edge [gray levels]
  double seen = 0.0;                                      // share of the outline that is on an edge
  int corner_count = 0;                                   // 0 for sphere and disc
  std::array<ImagePoint, kMaxCorners> corner{};           // in the order of O's corners
  int outline_count = 0;                                  // for drawing; closed
  std::array<ImagePoint, kOutlinePoints> outline{};

  [[nodiscard]] std::span<const ImagePoint> Outline() const {
    return {outline.data(), static_cast<std::size_t>(outline_count)};
  }
  [[nodiscard]] std::span<const ImagePoint> Corners() const {
    return {corner.data(), static_cast<std::size_t>(corner_count)};
  }
  // A point in front of the camera in the direction of the target's centre, in axes of C; only when found.
  [[nodiscard]] model::Vec3 Middle() const {
    const bool is_disc = features::TraitsOf(kind).body == features::TargetBody::kDisc;
    return pose_count > 0 ? pose[0].X_CO.p
           : is_disc      ? model::Vec3(s[0], s[1], 1.0)
                          : model::Vec3(s.head<3>());
  }
};

}  // namespace fovea::vision
