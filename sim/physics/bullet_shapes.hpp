// A link's solids as Bullet collides them.
#pragma once

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <memory>

#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// In the shape's own frame S. A cylinder becomes a capsule, a mesh the hull of its points.
std::unique_ptr<btCollisionShape> MakeBulletShape(const Shape& shape);

}  // namespace fovea::sim
