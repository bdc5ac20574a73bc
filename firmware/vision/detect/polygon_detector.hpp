// SPDX-License-Identifier: Apache-2.0
// Plates with corners: find (polygon_finder.hpp), fit (polygon_fit.hpp), pose (flat_pose.hpp), judge.
#pragma once

#include <optional>
#include <vector>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/detector_config.hpp"
#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/find/edge_map.hpp"
#include "firmware/vision/find/polygon_finder.hpp"
#include "firmware/vision/fit/polygon_fit.hpp"
#include "firmware/vision/picture.hpp"
#include "firmware/vision/pose/flat_pose.hpp"

namespace fovea::vision {

class PolygonDetector {
 public:
  // std::invalid_argument: the number of corners does not match the kind of target.
  explicit PolygonDetector(const DetectorConfig& config);

  // The best detection in `area` of the image, which is searched at 1 / `factor` of its resolution.
  Detection Look(const Picture& image, const cv::Rect& area, int factor);
  // Keep: the last detection was the target; the next pose is chosen near it. Forget: the target is lost.
  void Keep() { X_CO_ = best_X_CO_; }
  void Forget() { X_CO_.reset(); }

 private:
  void Judge(const Picture& image, const PolygonCandidate& start, Detection& best);
  void DropPosesOutOfReach(CornerPoses& found) const;
  void SetCorners(const CornerFit& fit, int first, Detection& d) const;
  [[nodiscard]] double ColourShare(const Picture& image, std::span<const ImagePoint> corners) const;

  const DetectorConfig config_;
  const std::vector<Eigen::Vector2d> shape_;
  const int turns_;  // equal turns after which the target looks the same
  ColourModel colour_;
  PolygonLimits limits_;
  EdgeMap map_;
  PolygonFinder finder_;
  PolygonFitter fitter_;
  std::optional<model::Pose> X_CO_;  // in the last image
  model::Pose best_X_CO_;
};

}  // namespace fovea::vision
