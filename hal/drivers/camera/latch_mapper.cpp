#include "fovea/camera/latch_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fovea/hal/types.hpp"

namespace fovea::camera {
namespace {

constexpr std::int64_t kBlockNs = hal::kNsPerSecond;
constexpr std::int64_t kLostNs = hal::kNsPerSecond;
constexpr std::int64_t kWorstTripNs = 5 * hal::kNsPerMs;
constexpr std::int64_t kBelievedNs = 2 * hal::kNsPerSecond;  // after a reading: 0.1 ms at 50 ppm
constexpr std::int64_t kBelievedWithDriftNs = 10 * hal::kNsPerSecond;
constexpr double kSurelyNs = 1e4;  // a shorter round trip than this says no more

}  // namespace

void LatchMapper::Add(std::int64_t before_ns, std::int64_t device_ns, std::int64_t after_ns) {
  const std::int64_t trip_ns = after_ns - before_ns;
  if (trip_ns < 0 || trip_ns > kWorstTripNs) {
    return;
  }
  const Reading reading{device_ns, before_ns + trip_ns / 2 - device_ns, trip_ns};
  if (num_blocks_ > 0 &&
      (device_ns < last_device_ns_ || std::llabs(reading.excess_ns - LineAt(device_ns)) > kLostNs)) {
    ++restarts_;
    num_blocks_ = 0;
  }
  if (IsTooOld(device_ns)) {
    num_blocks_ = 0;
  }
  last_device_ns_ = device_ns;
  ++readings_;
  Keep(reading);
  FitLine();
}

void LatchMapper::Keep(const Reading& reading) {
  if (num_blocks_ == 0 || reading.device_ns - block_begin_ns_ >= kBlockNs) {
    if (num_blocks_ == kBlocks) {
      std::move(blocks_.begin() + 1, blocks_.end(), blocks_.begin());
      --num_blocks_;
    }
    block_begin_ns_ = reading.device_ns;
    blocks_[num_blocks_++] = reading;
  } else if (Reading& shortest = blocks_[num_blocks_ - 1]; reading.trip_ns < shortest.trip_ns) {
    shortest = reading;
  }
}

// Weighted least squares about the points' own middle; all that is subtracted is exact.
void LatchMapper::FitLine() {
  const Reading& newest = blocks_[num_blocks_ - 1];
  excess_base_ns_ = newest.excess_ns;
  const auto weight = [](const Reading& r) {
    const double trip = std::max(static_cast<double>(r.trip_ns), kSurelyNs);
    return 1.0 / (trip * trip);
  };
  double sum = 0.0;
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (std::size_t i = 0; i < num_blocks_; ++i) {
    const double w = weight(blocks_[i]);
    sum += w;
    x_mean += w * static_cast<double>(blocks_[i].device_ns - newest.device_ns);
    y_mean += w * static_cast<double>(blocks_[i].excess_ns - newest.excess_ns);
  }
  x_mean /= sum;
  y_mean /= sum;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < num_blocks_; ++i) {
    const double w = weight(blocks_[i]);
    const double x = static_cast<double>(blocks_[i].device_ns - newest.device_ns) - x_mean;
    const double y = static_cast<double>(blocks_[i].excess_ns - newest.excess_ns) - y_mean;
    xx += w * x * x;
    xy += w * x * y;
  }
  drift_ = num_blocks_ >= kBlocksForDrift ? xy / xx : 0.0;
  anchor_device_ns_ = newest.device_ns + std::llround(x_mean);
  anchor_excess_ns_ = y_mean;
}

std::int64_t LatchMapper::LineAt(std::int64_t device_ns) const {
  return excess_base_ns_ +
         std::llround(anchor_excess_ns_ + drift_ * static_cast<double>(device_ns - anchor_device_ns_));
}

bool LatchMapper::IsTooOld(std::int64_t device_ns) const {
  return device_ns - last_device_ns_ > (num_blocks_ < kBlocksForDrift ? kBelievedNs : kBelievedWithDriftNs);
}

std::optional<std::int64_t> LatchMapper::Map(std::int64_t device_ns) const {
  return num_blocks_ > 0 && !IsTooOld(device_ns) ? std::optional(device_ns + LineAt(device_ns))
                                                 : std::nullopt;
}

}  // namespace fovea::camera
