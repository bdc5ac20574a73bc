// SPDX-License-Identifier: Apache-2.0
// Compares a device's clock with the host's: one point for each second of the last half minute, and a line
// along the points. latch_mapper.hpp and stamp_mapper.hpp differ in which point of a second is the best, and
// in how they fit the line.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fovea/hal/types.hpp"

namespace fovea::camera {

// Host time minus device time, as a line over the device time.
struct ClockLine {
  std::int64_t device_ns = 0;  // the line goes through this point
  std::int64_t excess_ns = 0;
  double drift = 0.0;  // seconds that the host's clock gains on the device's in a second

  [[nodiscard]] std::int64_t At(std::int64_t ns) const {
    constexpr double kMostNs = 1e18;  // bounds the drift's term, which must fit into 64 bits
    return excess_ns +
           std::llround(std::clamp(drift * static_cast<double>(ns - device_ns), -kMostNs, kMostNs));
  }
};

// Keeps the point with the least `kKey` of each second. A Point has device_ns and excess_ns, as above.
template <class Point, std::int64_t Point::*kKey>
class ClockPoints {
 public:
  // A device clock that goes back, or whose point lies too far below or above `line`, was set: the earlier
  // points are dropped. The point's device time must be a stamp (stamp.hpp).
  void Add(const Point& point, const ClockLine& line, std::int64_t most_below_ns,
           std::int64_t most_above_ns) {
    const std::int64_t off_ns = count_ > 0 ? point.excess_ns - line.At(point.device_ns) : 0;
    if (count_ > 0 &&
        (point.device_ns < last_device_ns_ || off_ns < -most_below_ns || off_ns > most_above_ns)) {
      StartAnew();
    }
    last_device_ns_ = point.device_ns;
    if (count_ == 0 || point.device_ns - begin_ns_ >= hal::kNsPerSecond) {
      if (count_ == kMost) {
        std::move(points_.begin() + 1, points_.end(), points_.begin());
        --count_;
      }
      begin_ns_ = point.device_ns;
      points_[count_++] = point;
    } else if (Point& best = points_[count_ - 1]; point.*kKey < best.*kKey) {
      best = point;
    }
  }
  void Forget() { count_ = 0; }
  void StartAnew() {
    ++restarts_;
    count_ = 0;
  }

  [[nodiscard]] std::span<const Point> all() const { return {points_.data(), count_}; }  // oldest first
  [[nodiscard]] bool enough_for_drift() const { return count_ >= kForDrift; }
  [[nodiscard]] std::int64_t last_device_ns() const { return last_device_ns_; }
  [[nodiscard]] std::uint64_t restarts() const { return restarts_; }

 private:
  static constexpr std::size_t kMost = 32;
  static constexpr std::size_t kForDrift = 8;

  std::array<Point, kMost> points_{};
  std::size_t count_ = 0;
  std::int64_t begin_ns_ = 0;  // of the newest second
  std::int64_t last_device_ns_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace fovea::camera
