// SPDX-License-Identifier: Apache-2.0
// Converts a device's stamps to the host's clock, from readings of the device's clock.
//
// The device latches its clock between question and answer. The middle of the two is taken as the host time,
// with an error of at most half the round trip. Of each second the reading with the shortest round trip
// counts. The line through those of the last half minute, weighted by their round trips, gives offset and
// drift. Neither depends on the transport time of pictures.
#pragma once

#include <cstdint>
#include <optional>

#include "fovea/camera/clock_points.hpp"

namespace fovea::camera {

class LatchMapper {
 public:
  // The device's clock showed `device_ns` at some host time from `before_ns` to `after_ns` [ns]. A reading
  // with a round trip above 5 ms, or of a value that is not a stamp (stamp.hpp), is ignored. The earlier
  // readings are dropped if the device clock goes back, is off the line by more than 20 ms, or was not read
  // for so long that Map gives nothing.
  void Add(std::int64_t before_ns, std::int64_t device_ns, std::int64_t after_ns);

  // The host's time of `device_ns`. None without a reading, for a value that is not a stamp, or if it is
  // later than the last reading by more than 2 s, or 10 s if the drift is known.
  [[nodiscard]] std::optional<std::int64_t> Map(std::int64_t device_ns) const;

  // Seconds that the host's clock gains on the device's in a second; 0 until 8 s are known.
  [[nodiscard]] double drift() const { return line_.drift; }
  [[nodiscard]] std::uint64_t readings() const { return readings_; }  // accepted ones
  [[nodiscard]] std::uint64_t restarts() const { return best_.restarts(); }

 private:
  struct Reading {
    std::int64_t device_ns = 0;
    std::int64_t excess_ns = 0;  // middle - device's
    std::int64_t trip_ns = 0;
  };

  void FitLine();
  [[nodiscard]] bool IsTooLate(std::int64_t device_ns) const;

  ClockPoints<Reading, &Reading::trip_ns> best_;  // the shortest of each second
  ClockLine line_;
  std::uint64_t readings_ = 0;
};

}  // namespace fovea::camera
