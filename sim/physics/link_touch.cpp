// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/link_touch.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>

#include "sim/physics/bullet_shapes.hpp"
#include "sim/physics/bullet_types.hpp"

namespace fovea::sim {
namespace {

constexpr int kNeighbours = 2;  // links at most this many joints apart are always close

struct Overlap final : btCollisionWorld::ContactResultCallback {
  bool found = false;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* /*a*/, int /*part*/,
                           int /*index*/, const btCollisionObjectWrapper* /*b*/, int /*part*/,
                           int /*index*/) override {
    found = found || point.getDistance() < 0.0;
    return 0.0;
  }
};

// The shapes of one link, or of the target, as one body.
struct Body {
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  btCompoundShape compound;
  btCollisionObject object;
  std::size_t link = 0;
  int rank = 0;  // moving joints between the base and the link
  btVector3 low, high;

  explicit Body(const std::vector<Shape>& parts) {
    for (const Shape& part : parts) {
      shapes.push_back(MakeBulletShape(part));
      compound.addChildShape(ToBullet(part.X_LS), shapes.back().get());
    }
    object.setCollisionShape(&compound);
  }
  void Place(const Eigen::Isometry3d& X) {
    object.setWorldTransform(ToBullet(X));
    compound.getAabb(object.getWorldTransform(), low, high);
  }
  [[nodiscard]] bool IsNear(const Body& other) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (low[axis] > other.high[axis] || other.low[axis] > high[axis]) {
        return false;
      }
    }
    return true;
  }
};

}  // namespace

struct LinkTouch::Impl {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btCollisionWorld world{&dispatcher, &broadphase, &configuration};  // has no objects: only pair tests
  std::vector<std::unique_ptr<Body>> links;
  std::unique_ptr<Body> target;

  bool Touch(Body& one, Body& other) {
    if (!one.IsNear(other)) {
      return false;
    }
    Overlap overlap;
    world.contactPairTest(&one.object, &other.object, overlap);
    return overlap.found;
  }
};

LinkTouch::LinkTouch(const SimRobot& robot, const std::optional<Shape>& target)
    : impl_(std::make_unique<Impl>()) {
  std::vector<int> rank(robot.links.size(), 0);
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    const SimLink& link = robot.links[k];
    if (link.parent >= 0) {
      rank[k] = rank[static_cast<std::size_t>(link.parent)] + (link.dof >= 0 ? 1 : 0);
    }
    if (!link.collisions.empty()) {
      impl_->links.push_back(std::make_unique<Body>(link.collisions));
      impl_->links.back()->link = k;
      impl_->links.back()->rank = rank[k];
    }
  }
  if (target) {
    impl_->target = std::make_unique<Body>(std::vector<Shape>{*target});
  }
}

LinkTouch::~LinkTouch() = default;

void LinkTouch::Place(const std::vector<Eigen::Isometry3d>& X_BL, const Eigen::Isometry3d& X_BO) {
  for (const auto& body : impl_->links) {
    body->Place(X_BL[body->link]);
  }
  if (impl_->target) {
    impl_->target->Place(X_BO);
  }
}

bool LinkTouch::Self() const {
  const auto& links = impl_->links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (std::size_t j = i + 1; j < links.size(); ++j) {
      if (std::abs(links[i]->rank - links[j]->rank) > kNeighbours && impl_->Touch(*links[i], *links[j])) {
        return true;
      }
    }
  }
  return false;
}

bool LinkTouch::Target() const {
  return impl_->target != nullptr &&
         std::any_of(impl_->links.begin(), impl_->links.end(),
                     [&](const auto& link) { return impl_->Touch(*link, *impl_->target); });
}

}  // namespace fovea::sim
