// Plates with corners: find (polygon_finder.hpp), fit (polygon_fit.hpp), pose (flat_pose.hpp), judge.
#pragma once

#include <optional>
#include <vector>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/detect/detector_config.hpp"
#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/find/edge_map.hpp"
#include "firmware/vision/find/polygon_finder.hpp"
#include "firmware/vision/fit/polygon_fit.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {

// The corners of the target in O that `config` names, turning from x to y.
std::vector<Eigen::Vector2d> CornersOf(const DetectorConfig& config);

class PolygonDetector {
 public:
  // std::invalid_argument: corners that are not as many as its kind of target has.
  explicit PolygonDetector(const DetectorConfig& config);

  // The best that is in `area` of the image, searched `factor` times smaller.
  Detection Look(const cv::Mat& image, const cv::Rect& area, int factor);
  // What Look found last was the target: the next image's pose is kept near its; or the target is lost.
  void Keep() { X_CO_ = best_X_CO_; }
  void Forget() { X_CO_.reset(); }

 private:
  void Judge(const cv::Mat& image, const PolygonCandidate& start, Detection& best);
  void DropPosesOutOfReach(CornerPoses& found) const;
  void SetCorners(const CornerFit& fit, int first, Detection& d) const;
  [[nodiscard]] double ColourShare(const cv::Mat& image, std::span<const ImagePoint> corners) const;

  const DetectorConfig config_;
  const std::vector<Eigen::Vector2d> shape_;
  const int turns_;  // of the target that look alike
  ColourModel colour_;
  PolygonLimits limits_;
  EdgeMap map_;
  PolygonFinder finder_;
  PolygonFitter fitter_;
  std::optional<model::Pose> X_CO_;  // in the image before
  model::Pose best_X_CO_;
};

}  // namespace fovea::vision
