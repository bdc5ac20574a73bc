// SPDX-License-Identifier: Apache-2.0
#include "fovea/v4l2/v4l2_camera.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "fovea/camera/camera_error.hpp"
#include "fovea/hal/types.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "v4l2_session.hpp"

namespace fovea::v4l2 {
namespace {

constexpr std::int64_t kLookPeriodNs = 500 * hal::kNsPerMs;

// Mid-exposure. Estimated from the arrival if the driver does not stamp in CLOCK_MONOTONIC.
std::int64_t StampOf(const v4l2_buffer& buffer, std::int64_t arrival_ns, std::int64_t exposure_ns,
                     std::int64_t transport_ns) {
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  if (monotonic && (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE) {
    return buffer.timestamp.tv_sec * hal::kNsPerSecond + buffer.timestamp.tv_usec * 1000 + exposure_ns / 2;
  }
  const std::int64_t end_ns =
      monotonic ? buffer.timestamp.tv_sec * hal::kNsPerSecond + buffer.timestamp.tv_usec * 1000 : arrival_ns;
  return end_ns - transport_ns - exposure_ns / 2;
}

}  // namespace

V4l2Camera::V4l2Camera(const V4l2Config& config, std::unique_ptr<Device> device)
    : config_(config), device_(std::move(device)), session_(std::make_unique<Session>(config_, *device_)) {
  name_ = session_->name();
}

V4l2Camera::~V4l2Camera() = default;

hal::Status V4l2Camera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  try {
    if (!session_ && !closed_ && config_.reconnect && !Reopen(timeout_ns)) {
      return hal::Status(hal::StatusCode::kTimeout, "camera is disconnected");
    }
    if (!session_) {
      return hal::Status(closed_ ? hal::StatusCode::kClosed : hal::StatusCode::kDisconnected, "camera");
    }
    const hal::Status status = Take(frame, closed_ ? 0 : timeout_ns);
    return closed_ && !status.ok() ? hal::Status(hal::StatusCode::kClosed, "camera") : status;
  } catch (const std::exception&) {  // OpenCV cannot convert the picture, or no memory
    return hal::Status(hal::StatusCode::kDeviceFault, "camera picture");
  }
}

// Opens the device again, waiting at most `timeout_ns`. True on success.
bool V4l2Camera::Reopen(std::int64_t timeout_ns) {
  const std::int64_t end_ns = linux_rt::MonotonicNs() + timeout_ns;
  if (next_look_ns_ > end_ns) {
    linux_rt::SleepUntilNs(end_ns);
    return false;
  }
  linux_rt::SleepUntilNs(next_look_ns_);
  next_look_ns_ = linux_rt::MonotonicNs() + kLookPeriodNs;
  try {
    session_ = std::make_unique<Session>(config_, *device_);
  } catch (const camera::CameraError&) {  // not yet
    return false;
  }
  ++counters_.reconnects;
  numbers_.Restart();
  return true;
}

hal::Status V4l2Camera::Take(hal::Frame& frame, std::int64_t timeout_ns) {
  const std::int64_t end_ns = linux_rt::MonotonicNs() + timeout_ns;
  std::optional<v4l2_buffer> newest;
  std::int64_t arrival_ns = 0;
  std::int64_t exposure_ns = 0;
  while (true) {
    v4l2_buffer buffer{};
    const int result = session_->Dequeue(buffer);
    if (result == 0) {
      const bool whole =
          (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && camera::Unpack(session_->PictureIn(buffer), picture_);
      counters_.incomplete += whole ? 0U : 1U;
      if (whole) {
        counters_.overtaken += newest ? 1U : 0U;
        newest = buffer;
        arrival_ns = linux_rt::MonotonicNs();
        exposure_ns = session_->exposure_ns();  // the session may end before the picture is returned
      }
      static_cast<void>(session_->Enqueue(buffer));  // the next Dequeue reports an error too
      continue;
    }
    if (result != -EAGAIN) {  // ENODEV: unplugged; other errors are handled alike
      ++counters_.disconnects;
      session_.reset();
      if (!newest) {
        return config_.reconnect ? hal::Status(hal::StatusCode::kTimeout, "camera is disconnected")
                                 : hal::Status(hal::StatusCode::kDisconnected, "camera");
      }
    }
    const std::int64_t left_ns = end_ns - linux_rt::MonotonicNs();
    if (newest || left_ns <= 0) {
      break;
    }
    static_cast<void>(device_->Wait(left_ns));  // the next Dequeue reports an error
  }
  if (!newest) {
    return hal::Status(hal::StatusCode::kTimeout, "camera");
  }
  frame = camera::FrameOf(picture_);
  frame.exposure_ns = std::max<std::int64_t>(exposure_ns, 1);
  frame.stamp_ns = StampOf(*newest, arrival_ns, frame.exposure_ns, config_.transport_ns);
  frame.sequence = numbers_.Count(newest->sequence);
  counters_.lost = numbers_.lost();
  ++counters_.frames;
  return hal::Status::Ok();
}

}  // namespace fovea::v4l2
