// SPDX-License-Identifier: Apache-2.0
// The pictures of a run: the camera's first and last frame, and a third-person view of the bench.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/vision/detection.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "fovea/hal/camera.hpp"
#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

// A kept frame with its detection.
struct KeptFrame {
  cv::Mat bgr;
  std::int64_t stamp_ns = 0;
  vision::Detection detection;
  model::Pose X_CO;  // the target's true pose
};

// Keeps the first and the newest frame of a run. The vision thread calls Keep; read the rest after its end,
// while the camera still exists.
class FrameKeeper {
 public:
  // `X_CO`: the target's true pose.
  void Keep(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t detected() const { return detected_; }
  [[nodiscard]] const KeptFrame& first() const { return first_; }
  [[nodiscard]] const KeptFrame& last();

 private:
  KeptFrame first_;
  KeptFrame last_;
  hal::Frame in_parts_;  // the last one, if its pixels are made on demand
  std::uint64_t frames_ = 0;
  std::uint64_t detected_ = 0;
};

// The frame at twice its size with target (true outline), detection and goal drawn in, and a legend; as PNG.
std::string DrawEyePicture(const KeptFrame& frame, const vision::Intrinsics& intrinsics,
                           const features::TargetFeature& target);

// The frame as the camera gave it, as PNG.
std::string DrawFrame(const KeptFrame& frame);

// The bench viewed from beside it, with the paths of camera and target, as PNG. `camera_path` and
// `target_path` are points in B [m].
std::string DrawBenchPicture(const RenderScene& scene, const Exposure& exposure,
                             const std::vector<Eigen::Vector3d>& camera_path,
                             const std::vector<Eigen::Vector3d>& target_path);

}  // namespace fovea::sim
