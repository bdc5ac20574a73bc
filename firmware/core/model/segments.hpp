// SPDX-License-Identifier: Apache-2.0
// The nearest points of two segments.
#pragma once

#include <cmath>

#include "firmware/core/model/types.hpp"

namespace fovea::model {

struct SegmentPair {
  double distance = HUGE_VAL;  // [m]
  double s = 0.0;              // place on the first, as a share of its length from p1
  Vec3 on_first = Vec3::Zero();
  Vec3 on_second = Vec3::Zero();
};

// Of the segments from `p1` to `q1` and from `p2` to `q2` [m], all in one frame; length 0 is allowed.
// Ericson, Real-Time Collision Detection, 2005, 5.1.9. Real-time: yes.
[[nodiscard]] SegmentPair NearestOfSegments(const Vec3& p1, const Vec3& q1, const Vec3& p2,
                                            const Vec3& q2) noexcept;

}  // namespace fovea::model
