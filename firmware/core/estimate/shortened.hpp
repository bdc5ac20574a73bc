// A vector cut down to a length.
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// `v` with its direction, no longer than `most` >= 0. Real-time: yes.
[[nodiscard]] inline model::Vec3 Shortened(const model::Vec3& v, double most) noexcept {
  const double length = v.norm();
  return length <= most ? v : model::Vec3(v * (most / length));
}

}  // namespace fovea::estimate
