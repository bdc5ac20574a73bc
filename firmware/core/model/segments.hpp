// Where two segments are nearest to each other.
#pragma once

#include <cmath>

#include "firmware/core/model/types.hpp"

namespace fovea::model {

struct SegmentPair {
  double distance = HUGE_VAL;  // [m]
  double s = 0.0;              // on the first, as a share of its length, from its first point
  Vec3 on_first = Vec3::Zero();
  Vec3 on_second = Vec3::Zero();
};

// Of the segments from `p1` to `q1` and from `p2` to `q2` [m], all in one frame; one of length 0 is a point.
// Ericson, Real-Time Collision Detection, 2005, 5.1.9. Real-time: yes.
[[nodiscard]] SegmentPair NearestOfSegments(const Vec3& p1, const Vec3& q1, const Vec3& p2,
                                            const Vec3& q2) noexcept;

}  // namespace fovea::model
