// From an image to a target's feature: find, fit, judge. A false find is worse than none.
//
// What is round is fitted at once where the last images' targets lead to expect it. Else, or when it is not
// quite there, a small part of the image about that place is searched; then all of it, four times smaller,
// then two times.
#pragma once

#include <opencv2/core.hpp>
#include <variant>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/detect/detector_config.hpp"
#include "firmware/vision/detect/polygon_detector.hpp"
#include "firmware/vision/detect/round_detector.hpp"

namespace fovea::vision {

// One thread uses it. Allocates only when an image is larger, or fuller, than any before.
class TargetDetector {
 public:
  explicit TargetDetector(const DetectorConfig& config);

  // `image` is CV_8UC3 (BGR) or CV_8UC1, of the intrinsics' size.
  Detection Detect(const cv::Mat& image);

  // As if no image had been seen before.
  void Forget();

 private:
  using SphereDetector = RoundDetector<ConeCurve>;
  using DiscDetector = RoundDetector<EllipseCurve>;
  using AnyDetector = std::variant<SphereDetector, DiscDetector, PolygonDetector>;
  static AnyDetector Make(const DetectorConfig& config);
  Detection Look(const cv::Mat& image, const cv::Rect& area, int factor);
  Detection LookAgain(const cv::Mat& image);
  [[nodiscard]] cv::Rect ExpectedArea(const cv::Mat& image) const;

  // Middle and size of the outline.
  struct Place {
    double u_px = 0.0;
    double v_px = 0.0;
    double radius_px = 0.0;
  };

  const DetectorConfig config_;
  AnyDetector detector_;
  bool has_last_ = false;
  Place last_;
  Place step_;  // what changed from the one before to the last
};

}  // namespace fovea::vision
