// SPDX-License-Identifier: Apache-2.0
#include "fovea/camera/frame_counter.hpp"

#include <algorithm>

namespace fovea::camera {
namespace {

constexpr std::uint64_t kMostSteps = std::uint64_t{1} << 32U;  // more than a year of frames

}  // namespace

std::uint64_t FrameCounter::Count(std::uint64_t device) {
  std::uint64_t steps = 1;
  if (known_) {
    steps = device - last_device_;
    if (span_ != 0 && device < last_device_) {
      steps += span_;
    }
    const std::uint64_t most = span_ == 0 ? kMostSteps : std::min(span_ / 2, kMostSteps);
    if (steps == 0 || steps > most) {
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
