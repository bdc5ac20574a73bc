// A device's stamps on the host's clock, from nothing but when each came.
//
// A stamp comes the least transport time after it was true, or later: on a plot of (arrival - stamp) over
// the stamp all points lie above a line, whose slope is the drift between the clocks. The line is an edge of
// the points' lower convex hull (Zhang, Liu and Xia, Clock synchronization algorithms for network
// measurements, 2002), here of the earliest arrival in each second of the last half minute.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace fovea::camera {

class StampMapper {
 public:
  // `transport_ns`: the least time from a stamp to its arrival. What is not known of it stays in every stamp.
  explicit StampMapper(std::int64_t transport_ns) : transport_ns_(transport_ns) {}

  // The host's time of `device_ns`, which came at `arrival_ns` [ns]. Never later than its arrival, and later
  // than all before it. A device clock that goes back, or leaves the line by more than a second, has started
  // anew: what was known of it is forgotten.
  std::int64_t Map(std::int64_t device_ns, std::int64_t arrival_ns);
  void Restart();

  // Seconds that the host's clock gains on the device's in a second; 0 until 8 s are known.
  [[nodiscard]] double drift() const { return drift_; }
  [[nodiscard]] std::uint64_t restarts() const { return restarts_; }

 private:
  struct Point {
    std::int64_t device_ns = 0;
    std::int64_t excess_ns = 0;  // arrival - stamp
  };
  static constexpr std::size_t kBlocks = 32;
  static constexpr std::size_t kBlocksForDrift = 8;

  void Keep(const Point& point);
  void FitLine();
  [[nodiscard]] std::int64_t LineAt(std::int64_t device_ns) const;

  std::int64_t transport_ns_;
  std::array<Point, kBlocks> blocks_{};  // the least of each second; oldest first
  std::size_t num_blocks_ = 0;
  std::int64_t block_begin_ns_ = 0;  // of the newest
  Point anchor_;                     // the line goes through it
  double drift_ = 0.0;
  std::int64_t last_device_ns_ = 0;
  std::int64_t last_host_ns_ = INT64_MIN;
  std::uint64_t restarts_ = 0;
};

}  // namespace fovea::camera
