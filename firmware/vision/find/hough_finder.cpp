// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/hough_finder.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fovea::vision {

const std::vector<Circle>& HoughFinder::Find(const cv::Mat& image, const HoughConfig& config,
                                             double radius_min_px, double radius_max_px) {
  constexpr std::size_t kMostCircles = 16;
  if (image.channels() == 3) {
    cv::cvtColor(image, gray_, cv::COLOR_BGR2GRAY);
  }
  cv::GaussianBlur(image.channels() == 3 ? gray_ : image, blurred_, cv::Size(), config.blur_sigma_px);
  cv::HoughCircles(blurred_, hough_, cv::HOUGH_GRADIENT, config.resolution_px, config.spacing_px,
                   config.canny_threshold, config.votes, static_cast<int>(radius_min_px),
                   static_cast<int>(std::ceil(radius_max_px)));
  circles_.clear();
  for (std::size_t i = 0; i < std::min(hough_.size(), kMostCircles); ++i) {
    circles_.push_back({static_cast<double>(hough_[i][0]), static_cast<double>(hough_[i][1]),
                        static_cast<double>(hough_[i][2])});
  }
  return circles_;
}

}  // namespace fovea::vision
