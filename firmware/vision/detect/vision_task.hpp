// The camera-rate task: a frame from the camera becomes a feature for the servo.
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

// Frames that could not be looked at.
struct FrameFailures {
  std::uint64_t frames = 0;
  std::string first;  // why the first of them; one line
};

class VisionTask {
 public:
  explicit VisionTask(const DetectorConfig& config);

  // Looks at one frame. `measurement` says what was seen, also when nothing was.
  // kInvalidArgument, with `measurement` untouched: the frame cannot be looked at. Its size is not the
  // intrinsics', or the detector breaks on it, which then begins anew.
  hal::Status Process(const hal::Frame& frame, hal::FeatureMeasurement& measurement);

  // Counts a frame that the camera could not hand over.
  void MissFrame(const hal::Status& status);

  // What the last Process saw, for pictures and logs; nothing found where it could not look.
  [[nodiscard]] const Detection& last() const { return last_; }
  // Of all that Process got; from its thread, or when that is done.
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

// Called after each frame with what was seen in it; the frame's pixels are valid during the call. A frame of
// another size is shown as a black one.
using FrameObserver = std::function<void(const hal::Frame& frame, const Detection& detection)>;

// Takes frames from the camera until it closes or breaks, or `stop` becomes true, and puts a measurement of
// each into the sink. A frame that cannot be looked at counts as one without the target; one that the camera
// cannot hand over is counted alone, and 100 of those in a row are a camera that broke. Returns why it ended:
// kClosed for an orderly end. `observer` may be empty.
hal::Status RunVision(hal::Camera& camera, VisionTask& task, hal::FeatureSink& sink,
                      const std::atomic<bool>& stop, const FrameObserver& observer);

}  // namespace fovea::vision
