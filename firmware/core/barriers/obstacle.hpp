// How far a point is from the planes and boxes that it keeps out of, and which way leads away from them.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::barriers {

struct Clearance {
  double distance = 0.0;  // to the surface; below 0 within [m]
  model::Vec3 away = model::Vec3::UnitZ();
};

// Of `p_B` [m] to plane or box `i`, planes first, 0 <= i < CountObstacles. Within a box the way out is
// through its nearest face. Real-time: yes.
[[nodiscard]] Clearance ClearanceOf(const config::Obstacles& obstacles, int i,
                                    const model::Vec3& p_B) noexcept;
// Where the hand is nearest to plane or box `i`: its end effector's point, or a ball of `hand`, at `X_BE`.
// Real-time: yes.
struct HandClearance {
  Clearance clearance;
  model::Vec3 p_BP = model::Vec3::Zero();  // the hand's point, a ball's middle [m]
};
[[nodiscard]] HandClearance ClearanceOf(const config::Obstacles& obstacles, int i,
                                        const config::HandShape& hand, const model::Pose& X_BE) noexcept;
[[nodiscard]] inline int CountObstacles(const config::Obstacles& obstacles) noexcept {
  return obstacles.num_planes + obstacles.num_boxes;
}

}  // namespace fovea::barriers
