// SPDX-License-Identifier: Apache-2.0
// Test data: views of a flat target's corners from a moving camera, with noise of a given size.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

using features::Polygon;
using features::SeenCorners;
using model::Mat3;
using model::Pose;
using model::Vec3;

inline constexpr std::int64_t kFrameNs = 33'333'333;
inline constexpr double kFrameS = 1e-9 * static_cast<double>(kFrameNs);
inline constexpr double kFocalPx = 554.256;

inline Mat3 Turned(const Vec3& phi) {
  return phi.norm() > 0.0 ? Eigen::AngleAxisd(phi.norm(), phi.normalized()).toRotationMatrix()
                          : Eigen::Matrix3d::Identity();
}
inline Vec3 Between(const Mat3& R_to, const Mat3& R_from) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(R_to * R_from.transpose()));
  return turn.angle() * turn.axis();
}

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double Normal() { return normal_(engine_); }
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Vec3 Vector() { return {Normal(), Normal(), Normal()}; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

inline SeenCorners::Vector CornersOf(const Polygon& polygon, const Pose& X_CO) {
  SeenCorners::Vector xy(2 * polygon.num_corners);
  for (int i = 0; i < polygon.num_corners; ++i) {
    const Vec3 p = X_CO * polygon.corners[static_cast<std::size_t>(i)];
    xy.segment<2>(2 * i) << p.x() / p.z(), p.y() / p.z();
  }
  return xy;
}

// The view in frame `frame`: corners with noise `sigma_px`, the polygon's first corner numbered `shift`.
inline CornerView ViewOf(const Polygon& polygon, const Pose& X_BC, const Pose& X_BO, int frame,
                         double sigma_px, Draw& draw, int shift = 0) {
  CornerView view;
  view.stamp_ns = frame * kFrameNs;
  view.X_CB = X_BC.Inverse();
  const Pose X_CO = view.X_CB * X_BO;
  const SeenCorners::Vector xy = CornersOf(polygon, X_CO);
  const int n = polygon.num_corners;
  const double sigma = std::max(sigma_px, 1e-3) / kFocalPx;
  view.seen.xy.resize(2 * n);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 2; ++k) {
      view.seen.xy[2 * ((i + shift) % n) + k] =
          xy[2 * i + k] + (sigma_px > 0.0 ? sigma * draw.Normal() : 0.0);
    }
  }
  view.seen.cov = SeenCorners::Covariance::Identity(2 * n, 2 * n) * (sigma * sigma);
  view.seen.num_branches = 1;
  view.seen.branches[0] = {X_CO, shift};
  return view;
}

// Rolling shutter: moves each corner to where a target that moves by `v`, `w` is in the time of the corner's
// row. `X_BO`: at the stamp.
inline void RollRows(const Polygon& polygon, double row_time, const Pose& X_BO, const Vec3& v, const Vec3& w,
                     CornerView& view) {
  view.row_time = row_time;
  const int n = polygon.num_corners;
  const int shift = view.seen.branches[0].first;
  for (int i = 0; i < n; ++i) {
    const auto at = [&](double t) {
      const Pose moved{Turned(w * t) * X_BO.R, X_BO.p + t * v};
      const Vec3 p = view.X_CB * (moved * polygon.corners[static_cast<std::size_t>(i)]);
      return Eigen::Vector2d(p.head<2>() / p.z());
    };
    double t = 0.0;
    for (int round = 0; round < 20; ++round) {
      t = row_time * (at(t).y() - view.row_y);
    }
    view.seen.xy.segment<2>(2 * ((i + shift) % n)) += at(t) - at(0.0);
  }
}

// A camera that moves to and fro above the table and looks down.
inline Pose CameraAt(double t, double swing = 1.0) {
  Pose X_BC;
  X_BC.R = Turned({3.14159265, 0.0, 0.0}) *
           Turned({0.15 * swing * std::sin(1.1 * t), 0.2 * swing * std::sin(0.9 * t), 0.4 * t});
  X_BC.p = {0.5 + 0.08 * swing * std::sin(1.3 * t), 0.07 * swing * std::cos(t),
            0.5 + 0.05 * std::sin(0.7 * t)};
  return X_BC;
}

inline const Pose kOnTable{Turned({3.05, 0.1, 0.0}), {0.5, 0.03, 0.02}};

}  // namespace fovea::estimate
