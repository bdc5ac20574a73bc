// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/detect/vision_task.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <exception>
#include <opencv2/core.hpp>

namespace fovea::vision {
namespace {

constexpr int kMostCameraFaults = 100;  // in a row; a camera that stopped reports them without end

bool HasSizeOf(const Intrinsics& intrinsics, const hal::Frame& frame) {
  return frame.width_px == intrinsics.width_px && frame.height_px == intrinsics.height_px;
}

hal::FeatureMeasurement NothingFound(const hal::Frame& frame, hal::FeatureKind kind) {
  hal::FeatureMeasurement measurement;
  measurement.stamp_ns = frame.stamp_ns;
  measurement.sequence = frame.sequence;
  measurement.kind = kind;
  return measurement;
}

}  // namespace

VisionTask::VisionTask(const DetectorConfig& config) : config_(config), detector_(config) {
  // One thread, so that runs are bit-exact and other threads keep their cores.
  cv::setNumThreads(1);
}

hal::Status VisionTask::Refuse(const char* where, const std::string& why) {
  last_ = Detection{};
  last_.kind = config_.kind;
  if (++failures_.frames == 1) {
    failures_.first = why;
    std::replace(failures_.first.begin(), failures_.first.end(), '\n', ' ');
  }
  return hal::Status(hal::StatusCode::kInvalidArgument, where);
}

void VisionTask::MissFrame(const hal::Status& status) {
  static_cast<void>(
      Refuse(status.where(), std::string(hal::ToString(status.code())) + " (" + status.where() + ")"));
}

hal::Status VisionTask::Process(const hal::Frame& frame, hal::FeatureMeasurement& measurement) {
  if (!HasSizeOf(config_.intrinsics, frame)) {
    return Refuse("frame size", "a frame of " + std::to_string(frame.width_px) + " x " +
                                    std::to_string(frame.height_px) + " px; the camera is calibrated for " +
                                    std::to_string(config_.intrinsics.width_px) + " x " +
                                    std::to_string(config_.intrinsics.height_px));
  }
  const int type = CV_8UC(hal::BytesPerPixel(frame.format));
  // A view of the camera's pixels; OpenCV's type has no const.
  const cv::Mat pixels(frame.height_px, frame.width_px, type, const_cast<std::uint8_t*>(frame.pixels.data()),
                       static_cast<std::size_t>(frame.stride_bytes));
  const Picture image(pixels, frame.maker);
  image.Need(detector_.FirstLook(), picture_.Patches(frame.width_px, frame.height_px));
  const std::int64_t same_for_ns = picture_.Look(image, frame.stamp_ns);
  try {
    last_ = detector_.Detect(image);
  } catch (const std::exception& error) {
    detector_.Forget();
    return Refuse("detection", error.what());
  }

  measurement = NothingFound(frame, last_.kind);
  measurement.same_for_ns = same_for_ns;
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
  constexpr std::int64_t kPollNs = 100'000'000;  // period of checking `stop` while no frame arrives
  std::vector<std::uint8_t> black;               // shown in place of a picture of the wrong size
  int faults = 0;                                // of the camera, in a row
  while (!stop.load(std::memory_order_relaxed)) {
    hal::Frame frame;
    const hal::Status status = camera.Acquire(frame, kPollNs);
    if (status.code() == hal::StatusCode::kTimeout) {
      continue;
    }
    if (status.code() == hal::StatusCode::kDeviceFault && ++faults < kMostCameraFaults) {
      task.MissFrame(status);
      continue;
    }
    if (!status.ok()) {
      return status;
    }
    faults = 0;
    hal::FeatureMeasurement measurement;
    if (!task.Process(frame, measurement).ok()) {
      measurement = NothingFound(frame, task.config().kind);
      if (!HasSizeOf(task.config().intrinsics, frame)) {
        frame.width_px = task.config().intrinsics.width_px;
        frame.height_px = task.config().intrinsics.height_px;
        frame.stride_bytes = frame.width_px * hal::BytesPerPixel(frame.format);
        black.resize(static_cast<std::size_t>(frame.stride_bytes) *
                     static_cast<std::size_t>(frame.height_px));
        frame.pixels = black;
        frame.maker = nullptr;
      }
    }
    sink.Put(measurement);
    if (observer) {
      observer(frame, task.last());
    }
  }
  return hal::Status(hal::StatusCode::kClosed, "vision");
}

}  // namespace fovea::vision
