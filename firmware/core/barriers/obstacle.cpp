// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/obstacle.hpp"

namespace fovea::barriers {
namespace {

Clearance ClearanceOf(const config::Box& box, const model::Vec3& p) noexcept {
  model::Vec3 outside = model::Vec3::Zero();  // vector from the box's nearest point
  double nearest_face = HUGE_VAL;
  int axis = 0;
  double side = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double below = box.low[i] - p[i];
    const double above = p[i] - box.high[i];
    outside[i] = above > 0.0 ? above : below > 0.0 ? -below : 0.0;
    if (-above < nearest_face) {
      nearest_face = -above;
      axis = i;
      side = 1.0;
    }
    if (-below < nearest_face) {
      nearest_face = -below;
      axis = i;
      side = -1.0;
    }
  }
  const double distance = outside.norm();
  if (distance > 0.0) {
    return {distance, outside / distance};
  }
  Clearance clearance;
  clearance.distance = -nearest_face;
  clearance.away = side * model::Vec3::Unit(axis);
  return clearance;
}

}  // namespace

Clearance ClearanceOf(const config::Obstacles& obstacles, int i, const model::Vec3& p_B) noexcept {
  if (i < obstacles.num_planes) {
    const config::Plane& plane = obstacles.planes[static_cast<std::size_t>(i)];
    return {plane.normal.dot(p_B) - plane.distance, plane.normal};
  }
  return ClearanceOf(obstacles.boxes[static_cast<std::size_t>(i - obstacles.num_planes)], p_B);
}

HandClearance ClearanceOf(const config::Obstacles& obstacles, int i, const config::HandShape& hand,
                          const model::Pose& X_BE) noexcept {
  HandClearance nearest{ClearanceOf(obstacles, i, X_BE.p), X_BE.p};
  for (int k = 0; k < hand.num_balls; ++k) {
    const config::HandShape::Ball& ball = hand.balls[static_cast<std::size_t>(k)];
    const model::Vec3 p_BP = X_BE * ball.p_EP;
    Clearance clearance = ClearanceOf(obstacles, i, p_BP);
    clearance.distance -= ball.radius;
    if (clearance.distance < nearest.clearance.distance) {
      nearest = {clearance, p_BP};
    }
  }
  return nearest;
}

}  // namespace fovea::barriers
