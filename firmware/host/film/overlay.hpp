// SPDX-License-Identifier: Apache-2.0
// Marks on a camera's picture: outlines and crosses, to a fraction of a pixel.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::film {

// Blue, green, red. The colours also differ in brightness.
inline const cv::Scalar kDetectionColour(255, 220, 60);
inline const cv::Scalar kGoalColour(60, 215, 255);
inline const cv::Scalar kTruthColour(255, 255, 255);
inline const cv::Scalar kLegendColour(38, 34, 30);  // behind text

inline constexpr int kSubPixelBits = 4;  // of OpenCV's fixed-point coordinates

class Overlay {
 public:
  // Draws on `image`, which shows the camera's picture enlarged by `scale`. Both are borrowed.
  Overlay(cv::Mat& image, const vision::Intrinsics& intrinsics, int scale)
      : image_(image), in_(intrinsics), scale_(scale) {}

  // An outline's points in ideal pixels, evenly spaced; it is drawn closed or dashed, or not at all if empty.
  using Curve = std::vector<vision::ImagePoint>;
  static Curve CurveOf(const vision::Intrinsics& intrinsics, const model::Vec3& m);  // of cone |x| = x . m
  void Outline(std::span<const vision::ImagePoint> curve, const cv::Scalar& colour, int thickness,
               bool dashed);
  // A cross at the ray `p`, `arm_px` of the camera's pixels to each side.
  void Cross(const model::Vec3& p, double arm_px, const cv::Scalar& colour);

  // Goal: the target at its goal, dashed and with a cross. Detection: the detected target.
  void Goal(const Curve& outline, const Eigen::Vector3d& p_CO_C_star);
  void Detection(const vision::Detection& detection);

 private:
  [[nodiscard]] cv::Point At(double u_px, double v_px) const;

  cv::Mat& image_;
  const vision::Intrinsics& in_;
  int scale_;
};

void DrawText(cv::Mat& image, const std::string& text, int x, int y, double size, const cv::Scalar& colour);

}  // namespace fovea::film
