// SPDX-License-Identifier: Apache-2.0
// Limits the length of a vector.
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// `v`, shortened to the length `most` >= 0 if it is longer. Real-time: yes.
[[nodiscard]] inline model::Vec3 Shortened(const model::Vec3& v, double most) noexcept {
  const double length = v.norm();
  return length <= most ? v : model::Vec3(v * (most / length));
}

}  // namespace fovea::estimate
