// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/sim_camera.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fovea::sim {

SimCamera::SimCamera(const SimCameraConfig& config, Sensor sensor, std::vector<Painter> painters)
    : config_(config), sensor_(std::move(sensor)), auto_exposure_(config.auto_exposure) {
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
    job->index = exposed_++;
    if (!job->exposure.pixels_of) {
      frozen_gain_ = nullptr;
    } else if (frozen_gain_ == nullptr || frozen_gain_->sequence != job->exposure.pixels_of->sequence) {
      frozen_gain_ =
          std::make_shared<FrozenGain>(FrozenGain{job->exposure.pixels_of->sequence, std::nullopt});
    }
    job->frozen_gain = frozen_gain_;
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
  if ((*oldest)->progress == Progress::kWaiting) {
    auto_exposure_.Measure((*oldest)->index, (*oldest)->exposure.stamp_ns, std::nullopt);
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
    const double gain = config_.auto_exposure.IsOn() ? WaitForGain(*job) : 1.0;
    sensor_.Expose(rgba, config_.width_px,
                   exposure.pixels_of ? exposure.pixels_of->sequence : exposure.sequence, job->bgr, gain);
    if (painter.picture_done) {
      painter.picture_done();
    }
    {
      const double mean = config_.auto_exposure.IsOn() ? MeanOf(job->bgr) : 0.0;
      const std::lock_guard lock(mutex_);
      if (config_.auto_exposure.IsOn()) {
        auto_exposure_.Measure(job->index, exposure.stamp_ns, Brightness{mean, gain});
      }
      job->progress = Progress::kDone;
    }
    changed_.notify_all();
  }
}

// The picture two before this one may still be drawn by another painter. It does not wait for this one.
double SimCamera::WaitForGain(const Job& job) {
  std::unique_lock lock(mutex_);
  std::optional<double> gain;
  changed_.wait(lock, [&] {
    gain = TakeGain(job);
    return gain || !fault_.empty();
  });
  changed_.notify_all();
  return gain.value_or(1.0);
}

// None: it is not known yet.
std::optional<double> SimCamera::TakeGain(const Job& job) {
  FrozenGain* frozen = job.frozen_gain.get();
  if (frozen == nullptr) {
    return auto_exposure_.TakeGain(job.index);
  }
  if (!frozen->gain) {
    const auto first = std::find_if(jobs_.begin(), jobs_.end(),
                                    [&](const auto& other) { return other->frozen_gain == job.frozen_gain; });
    if (first == jobs_.end() || first->get() == &job) {
      frozen->gain = auto_exposure_.TakeGain(job.index);
    }
  }
  return frozen->gain;
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
  frame.maker = nullptr;
  return hal::Status::Ok();
}

}  // namespace fovea::sim
