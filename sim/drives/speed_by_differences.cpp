// SPDX-License-Identifier: Apache-2.0
#include "sim/drives/speed_by_differences.hpp"

#include <cmath>
#include <numbers>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
SpeedByDifferences::SpeedByDifferences(double corner_hz, double speed)
    : share_(-std::expm1(-2.0 * std::numbers::pi * corner_hz * hal::kTickPeriodS)), speed_(speed) {}

double SpeedByDifferences::Next(double reading) {
  if (has_reading_) {
    speed_ += share_ * ((reading - reading_) / hal::kTickPeriodS - speed_);
  }
  reading_ = reading;
  has_reading_ = true;
  return speed_;
}

}  // namespace fovea::sim
