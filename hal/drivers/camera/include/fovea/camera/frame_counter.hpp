// SPDX-License-Identifier: Apache-2.0
// Converts a device's frame numbers into one count that never goes back.
#pragma once

#include <cstdint>

namespace fovea::camera {

class FrameCounter {
 public:
  // Device numbers run from `first` to `last` and then start again; 64-bit numbers never do.
  FrameCounter(std::uint64_t first, std::uint64_t last) : span_(last - first + 1) {}
  FrameCounter() = default;  // all 64 bits

  // The count of the frame with number `device`; a gap stays a gap. A number that is more than half a cycle
  // or 2^32 frames ahead, or equal to the last one, comes from a restarted device: the frame counts as the
  // next.
  std::uint64_t Count(std::uint64_t device);
  // The device was opened again: its next frame counts as the next, whatever its number.
  void Restart() { known_ = false; }
  // The device's numbers turned out to have 64 bits.
  void Widen() { span_ = 0; }

  [[nodiscard]] std::uint64_t lost() const { return lost_; }

 private:
  std::uint64_t span_ = 0;  // 0: 2^64
  std::uint64_t last_device_ = 0;
  std::uint64_t next_ = 0;  // count
  std::uint64_t lost_ = 0;
  bool known_ = false;
};

}  // namespace fovea::camera
