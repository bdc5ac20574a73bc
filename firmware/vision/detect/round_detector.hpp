// SPDX-License-Identifier: Apache-2.0
// Sphere and disc: find (curve_finder.hpp or hough_finder.hpp), fit (curve_fit.hpp), judge.
#pragma once

#include <optional>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/detector_config.hpp"
#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/find/curve_finder.hpp"
#include "firmware/vision/find/edge_map.hpp"
#include "firmware/vision/find/hough_finder.hpp"
#include "firmware/vision/fit/curve_fit.hpp"
#include "firmware/vision/picture.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {

// ConeCurve: a sphere. EllipseCurve: a disc.
template <class Curve>
class RoundDetector {
 public:
  explicit RoundDetector(const DetectorConfig& config);

  // The best detection in `area` of the image, which is searched at 1 / `factor` of its resolution.
  Detection Look(const Picture& image, const cv::Rect& area, int factor);
  // The same without a search: fits the expected outline directly. Found if it is about as trustworthy as the
  // last one. Not found if no outline is expected.
  Detection LookAgain(const Picture& image);
  // Keep: the last detection was the target; the next one is expected near it. Forget: the target is lost.
  void Keep();
  void Forget() { last_.reset(); }

 private:
  void Judge(const Picture& image, const Curve& start, Detection& best);
  bool FeatureOf(const CurveFit<Curve>& fit, Detection& detection);
  // Both poses, the one nearest to the last image's pose first.
  bool DiscOf(const EllipseCurve& curve, double round_below, std::array<DiscPose, 2>& poses) const;
  [[nodiscard]] double ColourShare(const Picture& image, const Ellipse& ellipse) const;

  const DetectorConfig config_;
  ColourModel colour_;
  RoundLimits limits_;
  EdgeMap map_;
  CurveFinder<Curve> finder_;
  HoughFinder hough_;
  CurveFitter fitter_;
  // State of a target that its Detection does not contain.
  struct Known {
    Curve curve;
    Curve next;                                  // expected in the next image
    model::Vec3 normal_C = model::Vec3::Zero();  // of the disc
    double confidence = 0.0;
    double contrast = 0.0;
  };
  std::optional<Known> last_;  // in the last image
  Known best_;                 // in this image
  model::Vec3 candidate_normal_ = model::Vec3::Zero();
};

}  // namespace fovea::vision
