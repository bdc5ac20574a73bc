// SPDX-License-Identifier: Apache-2.0
// Converts a device's stamps to the host's clock, from their arrival times alone.
//
// A stamp arrives the least transport time after it was taken, or later. In a plot of (arrival - stamp) over
// the stamp, all points lie above a line whose slope is the drift between the clocks. The line is an edge of
// the points' lower convex hull (Zhang, Liu and Xia, Clock synchronization algorithms for network
// measurements, 2002), here of the earliest arrival in each second of the last half minute.
#pragma once

#include <cstddef>
#include <cstdint>

#include "fovea/camera/clock_points.hpp"

namespace fovea::camera {

class StampMapper {
 public:
  // `transport_ns`: the least time from a stamp to its arrival. An error of it stays in every stamp.
  explicit StampMapper(std::int64_t transport_ns) : transport_ns_(transport_ns) {}

  // The host's time of `device_ns`, which arrived at `arrival_ns` [ns]: not later than the arrival, and
  // strictly increasing. For a value that is not a stamp (stamp.hpp), the arrival minus transport_ns. The
  // known points are dropped if the device clock was set: it goes back, a stamp arrives 20 ms too early or a
  // second too late, or all stamps of a second arrive 20 ms too late.
  std::int64_t Map(std::int64_t device_ns, std::int64_t arrival_ns);
  void Restart();

  // Seconds that the host's clock gains on the device's in a second; 0 until 8 s are known.
  [[nodiscard]] double drift() const { return line_.drift; }
  [[nodiscard]] std::uint64_t restarts() const { return best_.restarts(); }

 private:
  struct Point {
    std::int64_t device_ns = 0;
    std::int64_t excess_ns = 0;  // arrival - stamp
  };

  // The stamps that arrived far too late since the last one that did not.
  struct Late {
    std::size_t count = 0;
    std::int64_t since_ns = 0;  // device time of the first
    Point least;
  };

  void LookForClockSetBack(const Point& point);
  void FitLine();

  std::int64_t transport_ns_;
  ClockPoints<Point, &Point::excess_ns> best_;  // the earliest of each second
  ClockLine line_;
  Late late_;
  std::int64_t last_host_ns_ = INT64_MIN;
};

}  // namespace fovea::camera
