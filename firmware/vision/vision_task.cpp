#include "fovea/vision/vision_task.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/core.hpp>

namespace fovea::vision {

VisionTask::VisionTask(const DetectorConfig& config) : intrinsics_(config.intrinsics), detector_(config) {
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
  measurement.kind = last_.kind;
  measurement.found = last_.found;
  measurement.confidence = last_.confidence;
  if (last_.found) {
    measurement.dim = static_cast<std::int32_t>(last_.s.size());
    std::copy(last_.s.begin(), last_.s.end(), measurement.s.begin());
    for (Eigen::Index row = 0; row < last_.cov_s.rows(); ++row) {
      for (Eigen::Index col = 0; col < last_.cov_s.cols(); ++col) {
        measurement.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)] = last_.cov_s(row, col);
      }
    }
    measurement.num_poses = last_.pose_count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(last_.pose_count); ++i) {
      const Detection::Pose& pose = last_.pose[i];
      const Eigen::Quaterniond q(pose.X_CO.R);
      measurement.poses[i] = {
          {pose.X_CO.p.x(), pose.X_CO.p.y(), pose.X_CO.p.z()}, {q.w(), q.x(), q.y(), q.z()}, pose.first};
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
