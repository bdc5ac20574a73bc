// SPDX-License-Identifier: Apache-2.0
// The space that the arm fills, in B: the capsules of its model (model::ArmShape) at a posture. All
// clearances of the arm's links use them: from each other, from planes and from lines of sight.
#pragma once

#include <array>

#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

// All points within `radius` of the segment from A to B.
struct PlacedCapsule {
  model::Vec3 p_BA;    // in B [m]
  model::Vec3 p_BB;    // in B [m]
  model::Vec3 middle;  // midpoint of the segment, in B [m]
  double radius;       // [m]
  double reach;        // radius of the ball about `middle` that contains the capsule [m]
};

struct ArmBodies {
  int size = 0;  // the base and each link
  std::array<PlacedCapsule, model::ArmShape::kMostBodies> body;
};

// Body 0 is the base. Body k is the link behind joint k - 1, which joints 0 to k - 1 move. Real-time: yes.
[[nodiscard]] ArmBodies PlaceBodies(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept;

}  // namespace fovea::barriers
