// A device's stamps on the host's clock, from nothing but when each came.
//
// A stamp comes the least transport time after it was true, or later: on a plot of (arrival - stamp) over
// the stamp all points lie above a line, whose slope is the drift between the clocks. The line is an edge of
// the points' lower convex hull (Zhang, Liu and Xia, Clock synchronization algorithms for network
// measurements, 2002), here of the earliest arrival in each second of the last half minute.
#pragma once

#include <cstddef>
#include <cstdint>

#include "fovea/camera/clock_points.hpp"

namespace fovea::camera {

class StampMapper {
 public:
  // `transport_ns`: the least time from a stamp to its arrival. What is not known of it stays in every stamp.
  explicit StampMapper(std::int64_t transport_ns) : transport_ns_(transport_ns) {}

  // The host's time of `device_ns`, which came at `arrival_ns` [ns]. Never later than its arrival, and later
  // than all before it. Of a stamp that is none (stamp.hpp) the arrival is taken. A device clock that goes
  // back was set anew, and what was known of it is forgotten; so was one that leaves the line: at once when
  // stamps come 20 ms before they can, or a second late; else when all of a second come 20 ms late.
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

  // The stamps that have come far too late since the last one that did not.
  struct Late {
    std::size_t count = 0;
    std::int64_t since_ns = 0;  // by the device
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
