// SPDX-License-Identifier: Apache-2.0
// Bullet's collision shapes of a link.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <memory>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// In the shape's own frame S. A cylinder becomes a capsule, a mesh its convex hull.
std::unique_ptr<btCollisionShape> MakeBulletShape(const Shape& shape);

}  // namespace fovea::sim
