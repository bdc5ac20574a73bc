// SPDX-License-Identifier: Apache-2.0
// The distance of points from planes and boxes, of segments from boxes, and the direction away from them.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::barriers {

struct Clearance {
  double distance = 0.0;  // to the surface; negative inside [m]
  model::Vec3 away = model::Vec3::UnitZ();
};

// The clearance of `p_B` [m] from plane or box `i` (planes first), 0 <= i < CountObstacles. Inside a box,
// `away` points to the nearest face. Real-time: yes.
[[nodiscard]] Clearance ClearanceOf(const config::Obstacles& obstacles, int i,
                                    const model::Vec3& p_B) noexcept;
// The hand's point nearest to plane or box `i`: the origin of E at `X_BE`, or the centre of a ball of `hand`.
// Real-time: yes.
struct HandClearance {
  Clearance clearance;
  model::Vec3 p_BP = model::Vec3::Zero();  // origin of E or centre of the nearest ball [m]
};
[[nodiscard]] HandClearance ClearanceOf(const config::Obstacles& obstacles, int i,
                                        const config::HandShape& hand, const model::Pose& X_BE) noexcept;

// The place of a segment that is nearest to a box.
struct SegmentClearance {
  Clearance clearance;
  model::Vec3 p_B = model::Vec3::Zero();  // in B [m]
  double s = 0.0;                         // as a share of the segment's length from its first end
};
// Of the segment from `a_B` to `b_B` [m]; length 0 is allowed. Of a segment that enters the box, the deepest
// place; `away` then points to one of the nearest faces. Real-time: yes.
[[nodiscard]] SegmentClearance ClearanceOf(const config::Box& box, const model::Vec3& a_B,
                                           const model::Vec3& b_B) noexcept;

[[nodiscard]] inline int CountObstacles(const config::Obstacles& obstacles) noexcept {
  return obstacles.num_planes + obstacles.num_boxes;
}

}  // namespace fovea::barriers
