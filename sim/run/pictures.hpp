// The pictures that a run leaves: what the eye saw first and last, and the bench from a third person's view.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/pose/intrinsics.hpp"
#include "fovea/hal/camera.hpp"
#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

// A frame that was kept, with what was seen in it.
struct KeptFrame {
  cv::Mat bgr;
  std::int64_t stamp_ns = 0;
  vision::Detection detection;
  model::Pose X_CO;  // where the target really was
};

// Keeps the first frame of a run and the newest. Called by the vision thread; read when that has ended.
class FrameKeeper {
 public:
  // `X_CO`: where the target really was.
  void Keep(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t detected() const { return detected_; }
  [[nodiscard]] const KeptFrame& first() const { return first_; }
  [[nodiscard]] const KeptFrame& last() const { return last_; }

 private:
  KeptFrame first_;
  KeptFrame last_;
  std::uint64_t frames_ = 0;
  std::uint64_t detected_ = 0;
};

// The frame at twice its size with target (true outline), detection and goal drawn in, and a legend; as PNG.
std::string DrawEyePicture(const KeptFrame& frame, const vision::Intrinsics& intrinsics,
                           const features::TargetFeature& target);

// The bench as someone standing beside it sees it, with the paths of camera and target drawn in; as PNG.
// `camera_path` and `target_path` are points in B [m].
std::string DrawBenchPicture(const RenderScene& scene, const Exposure& exposure,
                             const std::vector<Eigen::Vector3d>& camera_path,
                             const std::vector<Eigen::Vector3d>& target_path);

}  // namespace fovea::sim
