// SPDX-License-Identifier: Apache-2.0
// The course exercises' circle finder: gray image, Gaussian blur, Hough transform. Accurate to about a pixel.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "firmware/vision/detector_config.hpp"

namespace fovea::vision {

struct Circle {
  double u_px = 0.0;
  double v_px = 0.0;
  double radius_px = 0.0;
};

class HoughFinder {
 public:
  // Circles in `image` (CV_8UC3 BGR or CV_8UC1), the one with the most votes first.
  const std::vector<Circle>& Find(const cv::Mat& image, const HoughConfig& config, double radius_min_px,
                                  double radius_max_px);

 private:
  cv::Mat gray_, blurred_;
  std::vector<cv::Vec3f> hough_;
  std::vector<Circle> circles_;
};

}  // namespace fovea::vision
