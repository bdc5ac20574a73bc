// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/barrier.hpp"

#include <algorithm>

#include "firmware/core/barriers/barrier_speed.hpp"

namespace fovea::barriers {

double Barrier::SpeedMost() const noexcept {
  const double room = value - margin;
  if (rate > 0.0) {
    return std::max(rate * room + drift, 0.0);
  }
  if (!(room > 0.0) && return_rate > 0.0) {
    return std::max(return_rate * room, -return_speed);
  }
  return BarrierSpeed(room, deceleration, reaction_s);
}

}  // namespace fovea::barriers
