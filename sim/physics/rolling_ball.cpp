// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/rolling_ball.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "sim/physics/bullet_types.hpp"

namespace fovea::sim {
namespace {

btRigidBody::btRigidBodyConstructionInfo BodyInfo(double mass, btCollisionShape& shape,
                                                  const Eigen::Vector3d& p_BO) {
  btVector3 inertia(0, 0, 0);
  if (mass > 0.0) {
    shape.calculateLocalInertia(mass, inertia);
  }
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
  info.m_startWorldTransform.setOrigin(ToBullet(p_BO));
  return info;
}

}  // namespace

struct RollingBall::Impl {
  explicit Impl(const RollingBallConfig& config)
      : ball_shape(config.radius),
        table(BodyInfo(0.0, table_shape, Eigen::Vector3d::Zero())),
        ball(BodyInfo(config.mass, ball_shape, config.p_BO)) {
    // Bullet multiplies the two frictions, and each body's rolling resistance by the other body's friction.
    table.setFriction(1.0);
    ball.setFriction(config.friction);
    ball.setRollingFriction(config.rolling_resistance);
    ball.setDamping(config.air_damping, 0.0);
    ball.setActivationState(DISABLE_DEACTIVATION);
    world.setGravity(btVector3(0, 0, -kGravity));
    world.addRigidBody(&table);
    world.addRigidBody(&ball);
  }
  ~Impl() {
    world.removeRigidBody(&ball);
    world.removeRigidBody(&table);
  }

  btDefaultCollisionConfiguration collision_configuration;
  btCollisionDispatcher dispatcher{&collision_configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &collision_configuration};
  btStaticPlaneShape table_shape{btVector3(0, 0, 1), 0.0};
  btSphereShape ball_shape;
  btRigidBody table;
  btRigidBody ball;
};

RollingBall::RollingBall(const RollingBallConfig& config) : impl_(std::make_unique<Impl>(config)) {}
RollingBall::~RollingBall() = default;

void RollingBall::Push(const Eigen::Vector3d& impulse) { impl_->ball.applyCentralImpulse(ToBullet(impulse)); }

void RollingBall::Step(double dt) { impl_->world.stepSimulation(dt, 0); }

Eigen::Isometry3d RollingBall::X_BO() const {
  const btTransform& t = impl_->ball.getWorldTransform();
  const btQuaternion q = t.getRotation();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).toRotationMatrix();
  X.translation() = Eigen::Vector3d(t.getOrigin().x(), t.getOrigin().y(), t.getOrigin().z());
  return X;
}

Eigen::Vector3d RollingBall::v_BO() const {
  const btVector3& v = impl_->ball.getLinearVelocity();
  return {v.x(), v.y(), v.z()};
}

}  // namespace fovea::sim
