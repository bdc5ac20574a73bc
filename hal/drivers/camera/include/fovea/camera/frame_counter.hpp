// Numbers of frames as devices count them, made into one count that never goes back.
#pragma once

#include <cstdint>

namespace fovea::camera {

class FrameCounter {
 public:
  // Device numbers run from `first` to `last` and then start again; 64-bit ones never do.
  FrameCounter(std::uint64_t first, std::uint64_t last) : span_(last - first + 1) {}
  FrameCounter() = default;  // all 64 bits

  // The count of the frame with number `device`; a gap stays a gap. A number that would lie more than half a
  // round or 2^32 frames ahead, or is the last one again, is that of a device that started anew: it counts as
  // the next.
  std::uint64_t Count(std::uint64_t device);
  // The device was opened anew: whatever number comes is the next.
  void Restart() { known_ = false; }
  // The device's numbers have 64 bits after all.
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
