// SPDX-License-Identifier: Apache-2.0
// Poses of flat targets from their outlines: a disc from its ellipse, square and triangle from their corners.
//
// Each outline has several poses: a disc two, a square two (each in four equivalent quarter turns), a
// triangle up to four, and more with its corners exchanged. All that fit are returned, because one image does
// not distinguish them.
//
// A plate that looks the same after 1/k of a full turn (features::TargetTraits::turns) has k equivalent
// poses. Only the most likely of them is returned.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "firmware/core/model/types.hpp"
#include "firmware/vision/detection.hpp"
#include "firmware/vision/find/curve.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::vision {

struct DiscPose {
  model::Vec3 p_CO_C = model::Vec3::Zero();
  model::Vec3 normal_C{0.0, 0.0, 1.0};  // z of O, away from the camera
};

// The two poses of a disc of diameter `diameter` [m] with outline `conic` (in pixels). `round_below`: an
// outline whose 1 - minor / major is less than this cannot be distinguished from a circle and is taken for
// one; above it, the contribution of noise is subtracted. False if the conic is not an ellipse in front of
// the camera.
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
  double off_px = 0.0;                    // rms distance of the corners from their places in this pose
  // Above 1: the corners fit this pose so much worse than their covariance allows that it must be larger by
  // this factor.
  double misfit = 1.0;
  int first = 0;  // the image corner that is O's corner 0
};

struct CornerPoses {
  int count = 0;
  std::array<CornerPose, hal::kMaxPoses> pose;
};

// Corners of the target in O [m], z = 0, relative to their mean, ordered in the same sense as in the image.
using FlatShape = std::span<const Eigen::Vector2d>;

// The poses of a plate with corners `fit` that looks the same after each of `turns` equal turns; at most
// hal::kMaxPoses. First the one nearest to `last`, the pose in the last image. If `last` is null, first the
// one that faces the camera most squarely; the turn about the view axis breaks ties.
CornerPoses PosesOfCorners(const CornerFit& fit, const Intrinsics& in, FlatShape shape, int turns,
                           const model::Pose* last);

}  // namespace fovea::vision
