// Poses of flat targets from their outlines: a disc from its ellipse, square and triangle from their corners.
//
// Each outline has several poses: a disc two, a square two (and four by its quarter turns, which are one to
// it), a triangle up to four, and others with its corners taken for each other. Of a disc the one nearest to
// the last is kept; those of corners are all named, for one image does not tell them apart.
//
// A plate that looks the same after a k-th of a full turn (features::TargetTraits::turns) has k poses for
// one: the most likely of them is named.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "firmware/core/model/types.hpp"
#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/find/curve.hpp"
#include "firmware/vision/pose/intrinsics.hpp"

namespace fovea::vision {

struct DiscPose {
  model::Vec3 p_CO_C = model::Vec3::Zero();
  model::Vec3 normal_C{0.0, 0.0, 1.0};  // z of O, away from the camera
};

// The two poses of a disc of diameter `diameter` [m] whose outline is `conic` (of pixels). `round_below`: an
// outline whose tilt [1 - minor / major] is less than this cannot be told from a circle and is taken for one;
// the tilt above it counts less by what noise adds to it. False when the conic is no ellipse before the
// camera.
bool PosesOfDisc(const Eigen::Matrix3d& conic, const Intrinsics& in, double diameter, double round_below,
                 std::array<DiscPose, 2>& poses);

// Corners in the image, and the covariance of all their coordinates (u0, v0, u1, v1, ...) [px^2].
struct CornerFit {
  static constexpr int kMaxSize = 2 * Detection::kMaxCorners;
  using Covariance =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSize, kMaxSize>;
  int count = 0;
  std::array<ImagePoint, Detection::kMaxCorners> corner{};
  Covariance cov;
};

struct CornerPose {
  model::Pose X_CO;
  model::Mat6 cov = model::Mat6::Zero();  // position in axes of C [m], small rotation about axes of C [rad]
  double off_px = 0.0;                    // rms distance of the corners from where this pose has them
  int first = 0;                          // the image's corner that is O's corner 0
};

struct CornerPoses {
  int count = 0;
  std::array<CornerPose, hal::kMaxPoses> pose;
};

// Corners of the target in O [m], z = 0, about their mean, in the order that turns like the image's corners.
using FlatShape = std::span<const Eigen::Vector2d>;

// The poses of a plate that looks the same after each of `turns` equal turns and whose corners are `fit`, at
// most hal::kMaxPoses: first the one nearest to `last`, its pose in the image before; or, when that is null,
// the one that faces the camera most squarely, then the least turned about the view axis.
CornerPoses PosesOfCorners(const CornerFit& fit, const Intrinsics& in, FlatShape shape, int turns,
                           const model::Pose* last);

}  // namespace fovea::vision
