// What the arm fills of space, in B: the capsules of its model (model::ArmShape) at a posture. All that asks
// how near the arm comes to something asks these: itself, planes, lines of sight.
#pragma once

#include <array>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// All points within `radius` of the segment from A to B.
struct PlacedCapsule {
  model::Vec3 p_BA;    // in B [m]
  model::Vec3 p_BB;    // in B [m]
  model::Vec3 middle;  // of both, in B [m]
  double radius;       // [m]
  double reach;        // of the ball about `middle` that holds the capsule [m]
};

struct ArmBodies {
  int size = 0;  // the base, and each link
  std::array<PlacedCapsule, model::ArmShape::kMostBodies> body;
};

// Body 0 is the base, body k the link that joint k - 1 moves: joints 0 to k - 1 move it.
// Real-time: yes.
[[nodiscard]] ArmBodies PlaceBodies(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
