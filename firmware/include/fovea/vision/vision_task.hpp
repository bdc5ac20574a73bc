// The camera-rate task: a frame from the camera becomes a feature for the servo.
#pragma once

#include <atomic>
#include <functional>

#include "fovea/hal/camera.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/vision/target_detector.hpp"

namespace fovea::vision {

class VisionTask {
 public:
  explicit VisionTask(const DetectorConfig& config);

  // Looks at one frame. `measurement` says what was seen, also when nothing was.
  // kInvalidArgument, with `measurement` untouched: the frame's size is not the intrinsics'.
  hal::Status Process(const hal::Frame& frame, hal::FeatureMeasurement& measurement);

  // What the last Process saw, for pictures and logs.
  [[nodiscard]] const Detection& last() const { return last_; }

 private:
  const Intrinsics intrinsics_;
  TargetDetector detector_;
  Detection last_;
};

// Called after each frame with what was seen in it; the frame's pixels are valid during the call.
using FrameObserver = std::function<void(const hal::Frame& frame, const Detection& detection)>;

// Takes frames from the camera until it closes or breaks, or `stop` becomes true, and puts a measurement of
// each into the sink. Returns why it ended: kClosed for an orderly end. `observer` may be empty.
hal::Status RunVision(hal::Camera& camera, VisionTask& task, hal::FeatureSink& sink,
                      const std::atomic<bool>& stop, const FrameObserver& observer);

}  // namespace fovea::vision
