// SPDX-License-Identifier: Apache-2.0
// Traces the vision task on a track: its waits for pictures, and each detection from picture to measurement.
#pragma once

#include "firmware/host/recording/trace/trace.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::trace {

// Stands between the vision task and its camera, and between the task and its sink. Borrows all.
class VisionTrace final : public hal::Camera, public hal::FeatureSink {
 public:
  VisionTrace(Track& track, hal::Camera& camera, hal::FeatureSink& sink) noexcept
      : track_(track), camera_(camera), sink_(sink) {}

  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;

  Track& track_;
  hal::Camera& camera_;
  hal::FeatureSink& sink_;
  std::int64_t acquired_ns_ = 0;
  std::int64_t put_ns_ = 0;  // 0: nothing was put since the last picture
};

}  // namespace fovea::trace
