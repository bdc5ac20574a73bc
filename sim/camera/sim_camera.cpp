// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/sim_camera.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fovea::sim {

SimCamera::SimCamera(const SimCameraConfig& config, Sensor sensor, std::vector<Painter> painters)
    : config_(config), sensor_(std::move(sensor)) {
  for (Painter& painter : painters) {
    workers_.emplace_back([this, painter = std::move(painter)] { Work(painter); });
  }
}

SimCamera::~SimCamera() {
  Close();
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

void SimCamera::Expose(Exposure exposure) {
  {
    const std::lock_guard lock(mutex_);
    if (jobs_.size() >= config_.queue) {
      LoseOldest();
    }
    auto job = std::make_shared<Job>();
    job->exposure = std::move(exposure);
    jobs_.push_back(std::move(job));
  }
  changed_.notify_all();
}

// A picture that a painter is drawing cannot be dropped.
void SimCamera::LoseOldest() {
  const auto oldest = std::find_if(jobs_.begin(), jobs_.end(),
                                   [](const auto& job) { return job->progress != Progress::kDrawing; });
  if (oldest == jobs_.end()) {
    return;
  }
  if ((*oldest)->progress == Progress::kDone) {
    spare_buffers_.push_back(std::move((*oldest)->bgr));
  }
  jobs_.erase(oldest);
  ++lost_;
}

void SimCamera::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

std::uint64_t SimCamera::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

std::string SimCamera::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

std::shared_ptr<SimCamera::Job> SimCamera::NextWaiting() const {
  const auto found = std::find_if(jobs_.begin(), jobs_.end(),
                                  [](const auto& job) { return job->progress == Progress::kWaiting; });
  return found == jobs_.end() ? nullptr : *found;
}

void SimCamera::Work(const Painter& painter) {
  DrawUntilClosed(painter);
  if (painter.leave_thread) {
    painter.leave_thread();
  }
}

void SimCamera::DrawUntilClosed(const Painter& painter) {
  const std::size_t pixels =
      static_cast<std::size_t>(config_.width_px) * static_cast<std::size_t>(config_.height_px);
  std::vector<std::uint8_t> rgba(pixels * 4);
  while (true) {
    std::shared_ptr<Job> job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || !fault_.empty() || NextWaiting() != nullptr; });
      job = NextWaiting();
      if (job == nullptr || !fault_.empty()) {
        return;
      }
      job->progress = Progress::kDrawing;
      if (!spare_buffers_.empty()) {
        job->bgr = std::move(spare_buffers_.back());
        spare_buffers_.pop_back();
      }
    }
    try {
      painter.draw(job->exposure, rgba);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      fault_ = error.what();
      changed_.notify_all();
      return;
    }
    job->bgr.resize(pixels * 3);
    const Exposure& exposure = job->exposure;
    sensor_.Expose(rgba, config_.width_px,
                   exposure.pixels_of ? exposure.pixels_of->sequence : exposure.sequence, job->bgr);
    if (painter.picture_done) {
      painter.picture_done();
    }
    {
      const std::lock_guard lock(mutex_);
      job->progress = Progress::kDone;
    }
    changed_.notify_all();
  }
}

hal::Status SimCamera::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  std::shared_ptr<Job> job;
  {
    std::unique_lock lock(mutex_);
    const auto ready = [this] {
      return !fault_.empty() || (jobs_.empty() ? closed_ : jobs_.front()->progress == Progress::kDone);
    };
    if (!changed_.wait_for(lock, std::chrono::nanoseconds(timeout_ns), ready)) {
      return hal::Status(hal::StatusCode::kTimeout, "sim camera");
    }
    if (!fault_.empty()) {
      return hal::Status(hal::StatusCode::kDeviceFault, "sim camera");
    }
    if (jobs_.empty()) {
      return hal::Status(hal::StatusCode::kClosed, "sim camera");
    }
    job = jobs_.front();
    jobs_.pop_front();
    // The previous frame is no longer valid. Its buffer is reused.
    spare_buffers_.push_back(std::move(handed_out_));
    handed_out_ = std::move(job->bgr);
  }
  frame.stamp_ns = job->exposure.stamp_ns + job->exposure.stamp_error_ns;
  frame.exposure_ns = config_.exposure_ns;
  frame.sequence = job->exposure.sequence;
  frame.width_px = config_.width_px;
  frame.height_px = config_.height_px;
  frame.stride_bytes = config_.width_px * 3;
  frame.format = hal::PixelFormat::kBgr8;
  frame.pixels = handed_out_;
  return hal::Status::Ok();
}

}  // namespace fovea::sim
