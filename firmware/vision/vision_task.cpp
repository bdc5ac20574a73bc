#include "fovea/vision/vision_task.hpp"

#include <opencv2/core.hpp>

namespace fovea::vision {

VisionTask::VisionTask(const BallDetectorConfig& config) : intrinsics_(config.intrinsics), detector_(config) {
  // One thread, so that a run repeats to the bit and other threads keep their cores.
  cv::setNumThreads(1);
}

hal::Status VisionTask::Process(const hal::Frame& frame, hal::FeatureMeasurement& measurement) {
  if (frame.width_px != intrinsics_.width_px || frame.height_px != intrinsics_.height_px) {
    return hal::Status(hal::StatusCode::kInvalidArgument, "frame size");
  }
  const int type = frame.format == hal::PixelFormat::kMono8 ? CV_8UC1 : CV_8UC3;
  // A view of the camera's pixels; OpenCV's type has no const.
  const cv::Mat image(frame.height_px, frame.width_px, type, const_cast<std::uint8_t*>(frame.pixels.data()),
                      static_cast<std::size_t>(frame.stride_bytes));
  last_ = detector_.Detect(image);

  measurement = hal::FeatureMeasurement{};
  measurement.stamp_ns = frame.stamp_ns;
  measurement.sequence = frame.sequence;
  measurement.kind = hal::FeatureKind::kSphere;
  measurement.found = last_.found;
  measurement.confidence = last_.confidence;
  if (last_.found) {
    measurement.dim = 3;
    for (int row = 0; row < 3; ++row) {
      measurement.s[static_cast<std::size_t>(row)] = last_.s[row];
      for (int col = 0; col < 3; ++col) {
        measurement.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)] = last_.cov_s(row, col);
      }
    }
  }
  return hal::Status::Ok();
}

hal::Status RunVision(hal::Camera& camera, VisionTask& task, hal::FeatureSink& sink,
                      const std::atomic<bool>& stop, const FrameObserver& observer) {
  constexpr std::int64_t kPollNs = 100'000'000;  // how often `stop` is looked at while no frame comes
  while (!stop.load(std::memory_order_relaxed)) {
    hal::Frame frame;
    hal::Status status = camera.Acquire(frame, kPollNs);
    if (status.code() == hal::StatusCode::kTimeout) {
      continue;
    }
    hal::FeatureMeasurement measurement;
    if (status.ok()) {
      status = task.Process(frame, measurement);
    }
    if (!status.ok()) {
      return status;
    }
    sink.Put(measurement);
    if (observer) {
      observer(frame, task.last());
    }
  }
  return hal::Status(hal::StatusCode::kClosed, "vision");
}

}  // namespace fovea::vision
