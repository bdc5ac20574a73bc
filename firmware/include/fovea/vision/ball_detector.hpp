// From an image to a sphere's feature: find, refine, judge. A false find is worse than none.
#pragma once

#include <opencv2/core.hpp>

#include "fovea/model/types.hpp"
#include "fovea/vision/ball_finder.hpp"
#include "fovea/vision/intrinsics.hpp"
#include "fovea/vision/outline_fit.hpp"

namespace fovea::vision {

struct BallDetectorConfig {
  Intrinsics intrinsics;
  FinderConfig finder;
  double radius = 0.04;         // of the ball [m]
  double distance_min = 0.12;   // a ball can only be this near [m]
  double distance_max = 1.20;   // or this far [m]: smaller round things are something else
  double confidence_min = 0.5;  // finds below it are refused, 0 to 1
};

struct BallDetection {
  bool found = false;
  bool tracked = false;                 // found where the last one led to expect it, without a search
  double confidence = 0.0;              // 0 to 1
  model::Vec3 s = model::Vec3::Zero();  // p_CO_C / radius
  model::Mat3 cov_s = model::Mat3::Zero();
  OutlineFit outline;
};

// One thread uses it. Allocates only when an image is larger than any before.
class BallDetector {
 public:
  explicit BallDetector(const BallDetectorConfig& config);

  // `image` is CV_8UC3 (BGR) or CV_8UC1, of the intrinsics' size.
  BallDetection Detect(const cv::Mat& image);

 private:
  BallDetection Judge(const cv::Mat& image, const OutlineFit& outline) const;
  [[nodiscard]] double ColourShare(const cv::Mat& image, const OutlineFit& outline) const;

  const BallDetectorConfig config_;
  BallFinder finder_;
  bool has_last_ = false;
  Circle last_;
  Circle step_;  // what changed from the one before to the last
};

}  // namespace fovea::vision
