// How far a point is from the planes and boxes that it keeps out of, and which way leads away from them.
#pragma once

#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

struct Clearance {
  double distance = 0.0;  // to the surface; below 0 within [m]
  model::Vec3 away = model::Vec3::UnitZ();
};

// Of `p_B` [m] to plane or box `i`, planes first, 0 <= i < CountObstacles. Within a box the way out is
// through its nearest face. Real-time: yes.
[[nodiscard]] Clearance ClearanceOf(const Obstacles& obstacles, int i, const model::Vec3& p_B) noexcept;
[[nodiscard]] inline int CountObstacles(const Obstacles& obstacles) noexcept {
  return obstacles.num_planes + obstacles.num_boxes;
}

}  // namespace fovea::servo
