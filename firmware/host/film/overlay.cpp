// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/film/overlay.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "firmware/vision/fit/outline.hpp"

namespace fovea::film {
namespace {

constexpr int kCurvePoints = 96;
constexpr int kDash = 2;  // segments drawn, then as many left out

}  // namespace

// Applies the lens distortion and the scale; pixel centres stay pixel centres.
cv::Point Overlay::At(double u_px, double v_px) const {
  in_.Distort(u_px, v_px);
  const double one = 1 << kSubPixelBits;
  return {static_cast<int>(std::lround((scale_ * (u_px + 0.5) - 0.5) * one)),
          static_cast<int>(std::lround((scale_ * (v_px + 0.5) - 0.5) * one))};
}

Overlay::Curve Overlay::CurveOf(const vision::Intrinsics& intrinsics, const model::Vec3& m) {
  return vision::SphereOutline(intrinsics, m, kCurvePoints);
}

void Overlay::Outline(std::span<const vision::ImagePoint> curve, const cv::Scalar& colour, int thickness,
                      bool dashed) {
  if (curve.empty()) {
    return;
  }
  std::vector<cv::Point> points;
  points.reserve(curve.size() + 1);
  for (const vision::ImagePoint& p : curve) {
    points.push_back(At(p.u_px, p.v_px));
  }
  const auto draw = [&](const std::vector<cv::Point>& line, bool closed) {
    cv::polylines(image_, line, closed, colour, thickness, cv::LINE_AA, kSubPixelBits);
  };
  if (!dashed) {
    draw(points, true);
    return;
  }
  points.push_back(points.front());
  for (int i = 0; i < kCurvePoints; i += 2 * kDash) {
    draw({points.begin() + i, points.begin() + i + kDash + 1}, false);
  }
}

void Overlay::Cross(const model::Vec3& p, double arm_px, const cv::Scalar& colour) {
  const double u = in_.U(p);
  const double v = in_.V(p);
  cv::line(image_, At(u - arm_px, v), At(u + arm_px, v), colour, 1, cv::LINE_AA, kSubPixelBits);
  cv::line(image_, At(u, v - arm_px), At(u, v + arm_px), colour, 1, cv::LINE_AA, kSubPixelBits);
}

void Overlay::Goal(const Curve& outline, const Eigen::Vector3d& p_CO_C_star) {
  Outline(outline, kGoalColour, 2, true);
  Cross(p_CO_C_star, 9.0, kGoalColour);
}

void Overlay::Detection(const vision::Detection& detection) {
  if (detection.found) {
    Outline(detection.Outline(), kDetectionColour, 2, false);
    Cross(detection.Middle(), 5.0, kDetectionColour);
  }
}

void DrawText(cv::Mat& image, const std::string& text, int x, int y, double size, const cv::Scalar& colour) {
  cv::putText(image, text, {x, y}, cv::FONT_HERSHEY_DUPLEX, size, colour, 1, cv::LINE_AA);
}

}  // namespace fovea::film
