// SPDX-License-Identifier: Apache-2.0
// The detectors that `fovea-bench vision` compares: ours, and common methods that use OpenCV alone.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "tools/bench/vision/scenes.hpp"

namespace fovea::bench {

struct Answer {
  bool found = false;
  double u_px = 0.0;
  double v_px = 0.0;
  double radius_px = 0.0;
  double sigma_px = 0.0;                 // reported deviation of the centre along one axis; 0: none
  std::vector<Eigen::Vector2d> corners;  // of a polygon [px]
};

class Contestant {
 public:
  Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;
  virtual ~Contestant() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  // Look: detects without a hint. LookAgain: the same picture, with the last detection as a hint.
  virtual Answer Look(const cv::Mat& image) = 0;
  virtual Answer LookAgain(const cv::Mat& image) { return Look(image); }
  [[nodiscard]] virtual bool tracks() const { return false; }
};

// Our detector comes first. The others find round targets only.
std::vector<std::unique_ptr<Contestant>> MakeContestants(TargetKind kind, const PictureCamera& camera,
                                                         bool colour);

}  // namespace fovea::bench
