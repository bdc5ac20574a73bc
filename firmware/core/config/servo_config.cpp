// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/config/servo_config.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::config {

bool HandShape::AddCapsule(const model::Vec3& p_EA, const model::Vec3& p_EB, double radius) noexcept {
  const double length = (p_EB - p_EA).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / radius)));
  // Balls up to one radius apart cover the capsule if their radius is enlarged for the gap between them.
  const double step = length / steps;
  for (int i = 0; i <= steps; ++i) {
    if (num_balls >= kMost) {
      return false;
    }
    const double share = static_cast<double>(i) / steps;
    balls[static_cast<std::size_t>(num_balls++)] = {p_EA + share * (p_EB - p_EA),
                                                    std::sqrt(radius * radius + 0.25 * step * step)};
  }
  return true;
}

}  // namespace fovea::config
