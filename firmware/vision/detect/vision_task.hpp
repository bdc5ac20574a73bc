// SPDX-License-Identifier: Apache-2.0
// The camera-rate task: computes a feature for the servo from each frame of the camera.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/vision/detect/picture_watch.hpp"
#include "firmware/vision/detect/target_detector.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::vision {

// Frames that could not be processed.
struct FrameFailures {
  std::uint64_t frames = 0;
  std::string first;  // reason for the first of them; one line
};

class VisionTask {
 public:
  explicit VisionTask(const DetectorConfig& config);

  // Processes one frame into `measurement`, also if the target is not found.
  // kInvalidArgument, with `measurement` unchanged: the frame's size differs from the intrinsics', or the
  // detector threw an exception; then its tracking is reset.
  hal::Status Process(const hal::Frame& frame, hal::FeatureMeasurement& measurement);

  // Counts a frame that the camera could not deliver.
  void MissFrame(const hal::Status& status);

  // The detection of the last Process, for pictures and logs; not found if the frame could not be processed.
  [[nodiscard]] const Detection& last() const { return last_; }
  // All failures so far. From Process's thread, or after it has ended.
  [[nodiscard]] const FrameFailures& failures() const { return failures_; }
  [[nodiscard]] const DetectorConfig& config() const { return config_; }

 private:
  hal::Status Refuse(const char* where, const std::string& why);

  const DetectorConfig config_;
  TargetDetector detector_;
  PictureWatch picture_;
  Detection last_;
  FrameFailures failures_;
};

// Called after each frame with its detection; the frame's pixels are valid during the call. A frame of the
// wrong size is replaced by a black one.
using FrameObserver = std::function<void(const hal::Frame& frame, const Detection& detection)>;

// Takes frames from the camera until it closes or fails, or `stop` becomes true, and puts a measurement of
// each into the sink. A frame that cannot be processed gives a measurement without the target. A frame that
// the camera cannot deliver is only counted; the 100th of those in a row ends the task. Returns why it ended:
// kClosed for an orderly end. `observer` may be empty.
hal::Status RunVision(hal::Camera& camera, VisionTask& task, hal::FeatureSink& sink,
                      const std::atomic<bool>& stop, const FrameObserver& observer);

}  // namespace fovea::vision
