#include "fovea/camera/stamp_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

constexpr std::int64_t kBlockNs = hal::kNsPerSecond;
constexpr std::int64_t kLostNs = hal::kNsPerSecond;

}  // namespace

std::int64_t StampMapper::Map(std::int64_t device_ns, std::int64_t arrival_ns) {
  const Point point{device_ns, arrival_ns - device_ns};
  if (num_blocks_ > 0 &&
      (device_ns <= last_device_ns_ || std::llabs(point.excess_ns - LineAt(device_ns)) > kLostNs)) {
    ++restarts_;
    Restart();
  }
  last_device_ns_ = device_ns;
  Keep(point);
  FitLine();
  const std::int64_t host_ns = device_ns + LineAt(device_ns) - transport_ns_;
  last_host_ns_ = std::max(std::min(host_ns, arrival_ns), last_host_ns_ + 1);
  return last_host_ns_;
}

void StampMapper::Restart() {
  num_blocks_ = 0;
  drift_ = 0.0;
}

void StampMapper::Keep(const Point& point) {
  if (num_blocks_ == 0 || point.device_ns - block_begin_ns_ >= kBlockNs) {
    if (num_blocks_ == kBlocks) {
      std::move(blocks_.begin() + 1, blocks_.end(), blocks_.begin());
      --num_blocks_;
    }
    block_begin_ns_ = point.device_ns;
    blocks_[num_blocks_++] = point;
  } else if (Point& least = blocks_[num_blocks_ - 1]; point.excess_ns < least.excess_ns) {
    least = point;
  }
}

// The edge of the lower hull above the middle of the known time: of all lines below the points it is the one
// nearest to them, summed.
void StampMapper::FitLine() {
  const auto end = blocks_.begin() + static_cast<std::ptrdiff_t>(num_blocks_);
  if (num_blocks_ < kBlocksForDrift) {
    anchor_ = *std::min_element(blocks_.begin(), end,
                                [](const Point& a, const Point& b) { return a.excess_ns < b.excess_ns; });
    drift_ = 0.0;
    return;
  }
  const auto slope = [](const Point& a, const Point& b) {
    return static_cast<double>(b.excess_ns - a.excess_ns) / static_cast<double>(b.device_ns - a.device_ns);
  };
  const std::int64_t middle_ns =
      blocks_[0].device_ns + (blocks_[num_blocks_ - 1].device_ns - blocks_[0].device_ns) / 2;
  std::size_t corner = 0;
  while (true) {
    std::size_t next = num_blocks_ - 1;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = corner + 1; i < num_blocks_; ++i) {
      if (const double s = slope(blocks_[corner], blocks_[i]); s <= least) {
        least = s;
        next = i;
      }
    }
    if (blocks_[next].device_ns >= middle_ns) {
      anchor_ = blocks_[corner];
      drift_ = least;
      return;
    }
    corner = next;
  }
}

std::int64_t StampMapper::LineAt(std::int64_t device_ns) const {
  return anchor_.excess_ns + std::llround(drift_ * static_cast<double>(device_ns - anchor_.device_ns));
}

}  // namespace fovea::camera
