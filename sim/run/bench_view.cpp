// SPDX-License-Identifier: Apache-2.0
#include "sim/run/bench_view.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "firmware/host/film/overlay.hpp"

namespace fovea::sim {

Pinhole MakeBenchPinhole(int width_px, int height_px) {
  return MakePinhole(width_px, height_px, /*hfov=*/0.80);
}

// Looks from the bench's front corner at the space above the mat. For a tall arm the viewpoint is farther
// back and higher; for a wide arm it is farther back.
BenchView MakeBenchView(const Exposure& exposure, const Pinhole& pinhole) {
  double top = 0.0;
  double reach = 0.0;
  for (const Eigen::Isometry3d& X_BL : exposure.X_BL) {
    top = std::max(top, X_BL.translation().z());
    reach = std::max(reach, X_BL.translation().head<2>().norm());
  }
  const double taller = std::max(0.0, top - 0.75);  // excess over the height that fits the picture [m]
  const double wider = std::max(0.0, reach - 0.9);
  const Eigen::Vector3d look_at(0.30, 0.02, 0.33 + 0.4 * taller);
  const Eigen::Vector3d eye = look_at + (1.0 + taller + wider) * Eigen::Vector3d(1.42, -1.30, 0.69);
  BenchView view;
  view.pinhole = pinhole;
  const Eigen::Vector3d z = (look_at - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  view.X_BV.linear().col(0) = x;
  view.X_BV.linear().col(1) = z.cross(x);
  view.X_BV.linear().col(2) = z;
  view.X_BV.translation() = eye;
  return view;
}

void DrawPath(cv::Mat& bgr, const BenchView& view, const std::vector<Eigen::Vector3d>& path,
              const cv::Scalar& colour, int thickness) {
  const Eigen::Isometry3d X_VB = view.X_BV.inverse();
  const double one = 1 << film::kSubPixelBits;
  std::vector<cv::Point> points;
  points.reserve(path.size());
  for (const Eigen::Vector3d& p_B : path) {
    const Eigen::Vector3d p = X_VB * p_B;
    points.emplace_back(static_cast<int>(view.pinhole.U(p) * one), static_cast<int>(view.pinhole.V(p) * one));
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    cv::line(bgr, points[i - 1], points[i], colour, thickness, cv::LINE_AA, film::kSubPixelBits);
  }
}

}  // namespace fovea::sim
