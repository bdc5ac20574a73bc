// The vision task on a track: what it waits for, and each detection, from the picture to its measurement.
#pragma once

#include "firmware/host/recording/trace/trace.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::trace {

// Stands between the vision task and both of its ends; all are borrowed.
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
  std::int64_t put_ns_ = 0;  // 0: since the last picture nothing was put
};

}  // namespace fovea::trace
