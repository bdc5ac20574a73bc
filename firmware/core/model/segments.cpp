// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/segments.hpp"

#include <algorithm>

namespace fovea::model {

SegmentPair NearestOfSegments(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2) noexcept {
  constexpr double kPoint = 1e-12;  // [m^2]
  const Vec3 d1 = q1 - p1;
  const Vec3 d2 = q2 - p2;
  const Vec3 r = p1 - p2;
  const double a = d1.squaredNorm();
  const double e = d2.squaredNorm();
  const double f = d2.dot(r);
  SegmentPair nearest;
  double t = 0.0;
  if (a <= kPoint) {
    t = e > kPoint ? std::clamp(f / e, 0.0, 1.0) : 0.0;
  } else if (e <= kPoint) {
    nearest.s = std::clamp(-d1.dot(r) / a, 0.0, 1.0);
  } else {
    const double b = d1.dot(d2);
    const double c = d1.dot(r);
    const double denominator = a * e - b * b;
    nearest.s = denominator > kPoint ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
    t = (b * nearest.s + f) / e;
    if (t < 0.0 || t > 1.0) {
      t = std::clamp(t, 0.0, 1.0);
      nearest.s = std::clamp((b * t - c) / a, 0.0, 1.0);
    }
  }
  nearest.on_first = p1 + nearest.s * d1;
  nearest.on_second = p2 + t * d2;
  nearest.distance = (nearest.on_first - nearest.on_second).norm();
  return nearest;
}

}  // namespace fovea::model
