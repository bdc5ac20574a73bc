// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/on_demand_camera.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace fovea::sim {

OnDemandCamera::OnDemandCamera(const SimCameraConfig& config, Sensor sensor, Draw draw,
                               std::function<void()> leave_thread)
    : config_(config),
      sensor_(std::move(sensor)),
      draw_(std::move(draw)),
      leave_thread_(std::move(leave_thread)) {
  if (config.auto_exposure.IsOn()) {
    throw std::logic_error("a camera that draws parts of its pictures cannot measure their brightness");
  }
  const std::size_t pixels =
      static_cast<std::size_t>(config.width_px) * static_cast<std::size_t>(config.height_px);
  rgba_.resize(4 * pixels);
  bgr_.resize(3 * pixels);
}

void OnDemandCamera::Expose(Exposure exposure) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= config_.queue) {
      waiting_.pop_front();
      ++lost_;
    }
    waiting_.push_back(std::move(exposure));
  }
  changed_.notify_all();
}

void OnDemandCamera::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

std::uint64_t OnDemandCamera::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

std::string OnDemandCamera::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

hal::Status OnDemandCamera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return !fault_.empty() || closed_ || !waiting_.empty(); };
    if (!changed_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), ready)) {
      return hal::Status(hal::StatusCode::kTimeout, "sim camera");
    }
    if (!fault_.empty() || waiting_.empty()) {
      leave_thread_();
      return hal::Status(fault_.empty() ? hal::StatusCode::kClosed : hal::StatusCode::kDeviceFault,
                         "sim camera");
    }
    shown_ = std::move(waiting_.front());
    waiting_.pop_front();
  }
  made_.clear();
  frame.stamp_ns = shown_.stamp_ns + shown_.stamp_error_ns;
  frame.exposure_ns = config_.exposure_ns;
  frame.sequence = shown_.sequence;
  frame.width_px = config_.width_px;
  frame.height_px = config_.height_px;
  frame.stride_bytes = config_.width_px * 3;
  frame.format = hal::PixelFormat::kBgr8;
  frame.pixels = bgr_;
  frame.maker = this;
  return hal::Status::Ok();
}

void OnDemandCamera::Make(std::span<const hal::PixelArea> areas) noexcept {
  try {
    const bool is_whole = std::ranges::any_of(areas, [this](const hal::PixelArea& area) {
      return area.width_px == config_.width_px && area.height_px == config_.height_px;
    });
    for (const hal::PixelArea& area : areas) {
      made_.push_back({area.left_px, area.top_px, area.width_px, area.height_px});
    }
    draw_(shown_, is_whole ? std::span<const PictureArea>() : made_, rgba_);
    sensor_.Expose(rgba_, config_.width_px, shown_.pixels_of ? shown_.pixels_of->sequence : shown_.sequence,
                   bgr_);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    fault_ = error.what();
  }
}

}  // namespace fovea::sim
