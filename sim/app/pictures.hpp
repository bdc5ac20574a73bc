// The pictures that a run leaves: what the eye saw first and last, and the bench from a third person's view.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fovea/hal/camera.hpp"
#include "fovea/vision/ball_detector.hpp"
#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

// A frame that was kept, with what was seen in it.
struct KeptFrame {
  cv::Mat bgr;
  std::int64_t stamp_ns = 0;
  vision::BallDetection detection;
  Eigen::Vector3d p_CO_C = Eigen::Vector3d::Zero();  // where the target really was [m]
};

// Keeps the first frame of a run and the newest. Called by the vision thread; read when that has ended.
class FrameKeeper {
 public:
  // `p_CO_C`: where the target really was [m].
  void Keep(const hal::Frame& frame, const vision::BallDetection& detection, const Eigen::Vector3d& p_CO_C);
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
// `p_CO_C_star` is where the target shall be [m].
std::string DrawEyePicture(const KeptFrame& frame, const vision::Intrinsics& intrinsics, double radius,
                           const Eigen::Vector3d& p_CO_C_star);

// The bench as someone standing beside it sees it, with the paths of camera and target drawn in; as PNG.
// `camera_path` and `target_path` are points in B [m].
std::string DrawBenchPicture(const RenderScene& scene, const Exposure& exposure,
                             const std::vector<Eigen::Vector3d>& camera_path,
                             const std::vector<Eigen::Vector3d>& target_path);

}  // namespace fovea::sim
