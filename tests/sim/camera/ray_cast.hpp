// SPDX-License-Identifier: Apache-2.0
// An independent generator of pictures: casts rays at one ball or square that moves during the exposure. It
// shares no code with the renderer. Many rays per pixel, at many times of the pixel's own exposure.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

namespace fovea::test {

struct CastCamera {
  int width_px = 640;
  int height_px = 480;
  double f_px = 554.256258422041;
  double exposure_s = 0.005;
  double row_time_s = 0.0;  // the middle row is exposed at time 0
  int times = 20;           // of the exposure
  int rays = 5;             // per pixel, along each axis
  double k1 = 0.0;          // of Brown's lens: radial
  double k2 = 0.0;
  double p1 = 0.0;  // tangential
  double p2 = 0.0;
};

// The ray whose image through the lens is (x, y) in the normalised image, by iteration.
inline Eigen::Vector3d RayOf(const CastCamera& camera, double x, double y) {
  Eigen::Vector3d d(x, y, 1.0);
  for (int round = 0; round < 30; ++round) {
    const double r2 = d.x() * d.x() + d.y() * d.y();
    const double radial = 1.0 + camera.k1 * r2 + camera.k2 * r2 * r2;
    const double cross = 2.0 * d.x() * d.y();
    const double dx = camera.p1 * cross + camera.p2 * (r2 + 2.0 * d.x() * d.x());
    const double dy = camera.p2 * cross + camera.p1 * (r2 + 2.0 * d.y() * d.y());
    d = {(x - dx) / radial, (y - dy) / radial, 1.0};
  }
  return d;
}

// True if the ray `d` from the camera meets the target at time `t` [s].
using Meets = std::function<bool(const Eigen::Vector3d& d, double t)>;

// A ball of `radius` with its centre at `p_C(t)`.
inline Meets Ball(double radius, std::function<Eigen::Vector3d(double)> p_C) {
  return [=](const Eigen::Vector3d& d, double t) {
    const Eigen::Vector3d p = p_C(t);
    const double along = d.dot(p) / d.norm();
    return p.squaredNorm() - along * along < radius * radius;
  };
}

// A square of `side` in the plane z = 0 of its frame, which is at `X_CO(t)`.
inline Meets Square(double side, std::function<Eigen::Isometry3d(double)> X_CO) {
  return [=](const Eigen::Vector3d& d, double t) {
    const Eigen::Isometry3d X_OC = X_CO(t).inverse();
    const Eigen::Vector3d from = X_OC.translation();
    const Eigen::Vector3d along = X_OC.linear() * d;
    const Eigen::Vector3d hit = from - from.z() / along.z() * along;
    return std::fabs(hit.x()) < 0.5 * side && std::fabs(hit.y()) < 0.5 * side;
  };
}

// The picture of a red target on a gray ground. Rays are cast in `window` only; the rest is ground.
inline cv::Mat CastRays(const CastCamera& camera, const Meets& meets, const cv::Rect& window) {
  const cv::Vec3d red(15.0, 18.0, 190.0);
  const cv::Vec3d gray(120.0, 117.0, 115.0);
  cv::Mat bgr(camera.height_px, camera.width_px, CV_8UC3, cv::Scalar(gray[0], gray[1], gray[2]));
  for (int v = window.y; v < window.y + window.height; ++v) {
    const double row_s = (v - 0.5 * (camera.height_px - 1)) * camera.row_time_s;
    for (int u = window.x; u < window.x + window.width; ++u) {
      int met = 0;
      for (int i = 0; i < camera.rays * camera.rays; ++i) {
        const double du = (i % camera.rays + 0.5) / camera.rays - 0.5;
        const double dv = (i / camera.rays + 0.5) / camera.rays - 0.5;
        const Eigen::Vector3d d = RayOf(camera, (u + du - 0.5 * (camera.width_px - 1)) / camera.f_px,
                                        (v + dv - 0.5 * (camera.height_px - 1)) / camera.f_px);
        for (int k = 0; k < camera.times; ++k) {
          met += meets(d, row_s + camera.exposure_s * ((k + 0.5) / camera.times - 0.5)) ? 1 : 0;
        }
      }
      const double cover = static_cast<double>(met) / (camera.times * camera.rays * camera.rays);
      for (int c = 0; c < 3; ++c) {
        bgr.at<cv::Vec3b>(v, u)[c] =
            static_cast<std::uint8_t>(std::lround(gray[c] + cover * (red[c] - gray[c])));
      }
    }
  }
  return bgr;
}

}  // namespace fovea::test
