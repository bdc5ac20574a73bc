// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/trace/vision_trace.hpp"

namespace fovea::trace {

// The time between a measurement and the next request for a picture belongs to log and film.
hal::Status VisionTrace::DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept {
  const std::int64_t begin_ns = NowNs();
  if (put_ns_ > 0) {
    track_.Add({"log and film", put_ns_, begin_ns, -1, Flow::kNone});
    put_ns_ = 0;
  }
  const hal::Status status = camera_.Acquire(frame, timeout_ns);
  acquired_ns_ = NowNs();
  track_.Add({"wait for a picture", begin_ns, acquired_ns_, -1, Flow::kNone});
  return status;
}

void VisionTrace::Put(const hal::FeatureMeasurement& measurement) noexcept {
  track_.Add({"detect", acquired_ns_, NowNs(), static_cast<std::int64_t>(measurement.sequence), Flow::kStep});
  sink_.Put(measurement);
  put_ns_ = NowNs();
}

}  // namespace fovea::trace
