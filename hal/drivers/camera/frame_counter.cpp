#include "fovea/camera/frame_counter.hpp"

namespace fovea::camera {

std::uint64_t FrameCounter::Count(std::uint64_t device) {
  std::uint64_t steps = 1;
  if (known_) {
    steps = device - last_device_;
    if (span_ != 0 && device < last_device_) {
      steps += span_;
    }
    const std::uint64_t half = span_ == 0 ? std::uint64_t{1} << 63U : span_ / 2;
    if (steps == 0 || steps > half) {
      steps = 1;
    }
  }
  known_ = true;
  last_device_ = device;
  lost_ += steps - 1;
  next_ += steps;
  return next_ - 1;
}

}  // namespace fovea::camera
