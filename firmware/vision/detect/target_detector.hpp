// SPDX-License-Identifier: Apache-2.0
// Computes a target's feature from an image: find, fit, judge. A false detection is worse than none.
//
// A sphere or disc is first fitted directly at the place predicted from the last images. If that fails, or
// for other targets, a small area around the predicted place is searched; then the whole image, reduced by
// four, then by two.
#pragma once

#include <opencv2/core.hpp>
#include <variant>

#include "firmware/vision/detect/polygon_detector.hpp"
#include "firmware/vision/detect/round_detector.hpp"
#include "firmware/vision/detection.hpp"
#include "firmware/vision/detector_config.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

// For one thread. Allocates only when an image is larger, or has more edges, than any before.
class TargetDetector {
 public:
  explicit TargetDetector(const DetectorConfig& config);

  // `image` is CV_8UC3 (BGR) or CV_8UC1, of the intrinsics' size.
  Detection Detect(const Picture& image);

  // Where Detect looks first in a picture of the intrinsics' size. It may go on beside it, by Picture::Need.
  [[nodiscard]] cv::Rect FirstLook() const;

  // Resets the tracking, as if no image had been seen before.
  void Forget();

 private:
  using SphereDetector = RoundDetector<ConeCurve>;
  using DiscDetector = RoundDetector<EllipseCurve>;
  using AnyDetector = std::variant<SphereDetector, DiscDetector, PolygonDetector>;
  static AnyDetector Make(const DetectorConfig& config);
  Detection Look(const Picture& image, const cv::Rect& area, int factor);
  Detection LookAgain(const Picture& image);
  [[nodiscard]] cv::Rect ExpectedArea() const;

  // Centre and size of the outline.
  struct Place {
    double u_px = 0.0;
    double v_px = 0.0;
    double radius_px = 0.0;
  };

  const DetectorConfig config_;
  AnyDetector detector_;
  bool has_last_ = false;
  Place last_;
  Place step_;  // change from the last but one image to the last
};

}  // namespace fovea::vision
