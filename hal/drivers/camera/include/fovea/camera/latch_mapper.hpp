// A device's stamps on the host's clock, from readings of the device's clock.
//
// The device showed what it was asked for at some time between question and answer; the middle is taken for
// it, and is off by half of the round trip at the most. So of each second the reading with the shortest round
// trip counts, and the line through those of the last half minute, each weighted by its own, gives offset and
// drift: both however long a picture is on its way, and however late it is by chance.
#pragma once

#include <cstdint>
#include <optional>

#include "fovea/camera/clock_points.hpp"

namespace fovea::camera {

class LatchMapper {
 public:
  // The device's clock showed `device_ns` at some time from `before_ns` to `after_ns` of the host's [ns]. A
  // device clock that goes back, or leaves the line by more than a second, has started anew: what was known
  // of it is forgotten. So is a reading of which the round trip took longer than 5 ms, one of what is no
  // stamp (stamp.hpp), and what was known when none came for so long that Map has nothing more to say.
  void Add(std::int64_t before_ns, std::int64_t device_ns, std::int64_t after_ns);

  // The host's time of `device_ns`; none without a reading, of what is no stamp, nor when it is later than
  // the last one by more than 2 s, or 10 s where the drift is known.
  [[nodiscard]] std::optional<std::int64_t> Map(std::int64_t device_ns) const;

  // Seconds that the host's clock gains on the device's in a second; 0 until 8 s are known.
  [[nodiscard]] double drift() const { return line_.drift; }
  [[nodiscard]] std::uint64_t readings() const { return readings_; }  // that were not forgotten at once
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
