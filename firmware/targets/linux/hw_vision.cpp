// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_vision.hpp"

#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <utility>

#include "fovea/linux_rt/realtime.hpp"

namespace fovea::hw {
namespace {

constexpr int kFailedIsSaid = 100;  // failed pictures in a row that are reported

}  // namespace

HwVision::HwVision(const HwConfig& config, const features::TargetFeature& goal, std::int64_t start_ns,
                   hal::FeatureSink& features, vision::FrameObserver observer)
    : intrinsics_(config::MakeIntrinsics(config.camera.calibration)),
      p_CO_C_star_(goal.p_CO_C_star),
      camera_(OpenCamera(config, start_ns)),
      task_(config::MakeVisionConfig(config.vision, intrinsics_, config.target)),
      observer_(std::move(observer)) {
  thread_ = std::thread([this, &features] {
    linux_rt::MakeThreadYielding("fovea-vision");
    std::string failure;
    try {
      const hal::Status status =
          vision::RunVision(camera_->camera(), task_, features, stop_,
                            [this](const hal::Frame& frame, const vision::Detection& detection) {
                              Look(detection);
                              if (observer_) {
                                observer_(frame, detection);
                              }
                            });
      if (status.code() != hal::StatusCode::kClosed) {
        failure = fmt::format("{} ({})", hal::ToString(status.code()), status.where());
      }
    } catch (const std::exception& error) {
      failure = error.what();
    }
    const std::lock_guard lock(mutex_);
    failure_ = failure.empty() ? failure_ : failure;
    seen_.failures = task_.failures();
  });
}

HwVision::~HwVision() {
  stop_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void HwVision::Look(const vision::Detection& detection) {
  const std::lock_guard lock(mutex_);
  ++seen_.frames;
  failed_in_a_row_ = task_.failures().frames > seen_.failures.frames ? failed_in_a_row_ + 1 : 0;
  if (failed_in_a_row_ > 0) {
    seen_.failures = task_.failures();
  }
  if (failed_in_a_row_ == kFailedIsSaid) {
    failure_ =
        fmt::format("its last {} pictures could not be processed: {}", kFailedIsSaid, seen_.failures.first);
  }
  if (detection.found) {
    ++seen_.frames_detected;
    const model::Vec3 p = detection.Middle();
    seen_.last_px = std::hypot(intrinsics_.U(p) - intrinsics_.U(p_CO_C_star_),
                               intrinsics_.V(p) - intrinsics_.V(p_CO_C_star_));
  }
}

SeenError HwVision::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

std::string HwVision::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

CameraCounters HwVision::Finish() {
  stop_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
  return camera_->counters();
}

}  // namespace fovea::hw
