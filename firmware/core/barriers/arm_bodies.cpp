// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/arm_bodies.hpp"

namespace fovea::barriers {

ArmBodies PlaceBodies(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept {
  ArmBodies bodies;
  bodies.size = arm.num_joints + 1;
  for (std::size_t k = 0; k < static_cast<std::size_t>(bodies.size); ++k) {
    const model::Capsule& capsule = arm.shape.bodies[k];
    PlacedCapsule& placed = bodies.body[k];
    placed.p_BA = k == 0 ? capsule.p_LA : poses.X_BL[k - 1] * capsule.p_LA;
    placed.p_BB = k == 0 ? capsule.p_LB : poses.X_BL[k - 1] * capsule.p_LB;
    placed.middle = 0.5 * (placed.p_BA + placed.p_BB);
    placed.radius = capsule.radius;
    placed.reach = 0.5 * (placed.p_BB - placed.p_BA).norm() + capsule.radius;
  }
  return bodies;
}

}  // namespace fovea::barriers
