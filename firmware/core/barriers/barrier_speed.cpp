// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/barrier_speed.hpp"

#include <cmath>

namespace fovea::barriers {

double BarrierSpeed(double distance, double deceleration, double reaction_s) noexcept {
  if (!(distance > 0.0)) {
    return 0.0;
  }
  return deceleration * (std::sqrt(reaction_s * reaction_s + 2.0 * distance / deceleration) - reaction_s);
}

}  // namespace fovea::barriers
