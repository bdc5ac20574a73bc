// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/bullet_shapes.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "sim/physics/bullet_types.hpp"
#include "sim/physics/hull_points.hpp"

namespace fovea::sim {
namespace {

std::unique_ptr<btCollisionShape> MakeHull(const Mesh& mesh) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Eigen::Vector3d& point : HullPoints(mesh)) {
    hull->addPoint(ToBullet(point), /*recalculateLocalAabb=*/false);
  }
  hull->setMargin(0.0);  // Bullet's default would enlarge it by 40 mm on all sides
  hull->recalcLocalAabb();
  return hull;
}

}  // namespace

std::unique_ptr<btCollisionShape> MakeBulletShape(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kBox: return std::make_unique<btBoxShape>(ToBullet(shape.size) * 0.5);
    case ShapeKind::kSphere: return std::make_unique<btSphereShape>(shape.size[0]);
    case ShapeKind::kCylinder:  // a capsule: its contacts are cheap and smooth
      return std::make_unique<btCapsuleShapeZ>(shape.size[0], shape.size[1]);
    case ShapeKind::kMesh: break;
  }
  return MakeHull(*shape.mesh);
}

}  // namespace fovea::sim
