// Who takes part in `fovea-bench vision`: our detector and what people do with OpenCV alone.
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
  double sigma_px = 0.0;                 // what it says itself of its centre, along one axis; 0: nothing
  std::vector<Eigen::Vector2d> corners;  // of a polygon [px]
};

class Contestant {
 public:
  Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;
  virtual ~Contestant() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  // A picture without hint; and the same one again, when it keeps a hint from one to the next.
  virtual Answer Look(const cv::Mat& image) = 0;
  virtual Answer LookAgain(const cv::Mat& image) { return Look(image); }
  [[nodiscard]] virtual bool tracks() const { return false; }
};

// Ours first; the others know only what is round.
std::vector<std::unique_ptr<Contestant>> MakeContestants(TargetKind kind, const PictureCamera& camera,
                                                         bool colour);

}  // namespace fovea::bench
