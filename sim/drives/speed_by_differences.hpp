// SPDX-License-Identifier: Apache-2.0
// The speed of a joint from its encoder's readings: differences, smoothed by a first-order filter.
//
// The filter y += a (difference - y) / tick with a = 1 - exp(-2 pi f T), T the tick, has the corner frequency
// f. Its speed is late by T / 2 (a difference is the speed at the middle of a tick) + T (1 - a) / a.
#pragma once

namespace fovea::sim {

class SpeedByDifferences {
 public:
  // `corner_hz` > 0. `speed` [rad/s, m/s]: before the first reading.
  SpeedByDifferences(double corner_hz, double speed);

  // Takes the next tick's reading [rad, m]; the first one only begins the differences. Returns the speed
  // [rad/s, m/s].
  double Next(double reading);

 private:
  double share_;  // of a difference that the filter takes over per tick
  double speed_;
  double reading_ = 0.0;
  bool has_reading_ = false;
};

}  // namespace fovea::sim
