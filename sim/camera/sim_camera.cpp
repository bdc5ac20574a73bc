#include "sim/camera/sim_camera.hpp"

#include <chrono>
#include <utility>

namespace fovea::sim {

SimCamera::SimCamera(int width_px, int height_px, std::int64_t exposure_ns, Sensor sensor, DrawExposure draw)
    : width_px_(width_px),
      height_px_(height_px),
      exposure_ns_(exposure_ns),
      sensor_(std::move(sensor)),
      draw_(std::move(draw)),
      rgba_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * 4),
      bgr_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * 3) {}

void SimCamera::Expose(Exposure exposure) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() == kQueue) {
      waiting_.pop_front();
      ++lost_;
    }
    waiting_.push_back(std::move(exposure));
  }
  arrived_.notify_one();
}

void SimCamera::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  arrived_.notify_all();
}

std::uint64_t SimCamera::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

std::string SimCamera::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

hal::Status SimCamera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  Exposure exposure;
  {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return closed_ || !waiting_.empty(); };
    if (!arrived_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), ready)) {
      return hal::Status(hal::StatusCode::kTimeout, "sim camera");
    }
    if (waiting_.empty()) {
      return hal::Status(hal::StatusCode::kClosed, "sim camera");
    }
    exposure = std::move(waiting_.front());
    waiting_.pop_front();
  }
  try {
    draw_(exposure, rgba_);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    fault_ = error.what();
    return hal::Status(hal::StatusCode::kDeviceFault, "sim camera");
  }
  sensor_.Expose(rgba_, width_px_, exposure.sequence, bgr_);
  frame.stamp_ns = exposure.stamp_ns;
  frame.exposure_ns = exposure_ns_;
  frame.sequence = exposure.sequence;
  frame.width_px = width_px_;
  frame.height_px = height_px_;
  frame.stride_bytes = width_px_ * 3;
  frame.format = hal::PixelFormat::kBgr8;
  frame.pixels = bgr_;
  return hal::Status::Ok();
}

}  // namespace fovea::sim
