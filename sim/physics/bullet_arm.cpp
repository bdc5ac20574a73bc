// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/bullet_arm.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "sim/physics/bullet_shapes.hpp"
#include "sim/physics/bullet_types.hpp"
#include "sim/physics/multi_body_joints.hpp"
#include "sim/physics/multi_body_links.hpp"
#include "sim/physics/rotors.hpp"
#include "sim/physics/weight_on_joints.hpp"

namespace fovea::sim {
namespace {

// Bullet's world without the predicted link poses between two steps, which only soft bodies need.
class RigidWorld final : public btMultiBodyDynamicsWorld {
 public:
  using btMultiBodyDynamicsWorld::btMultiBodyDynamicsWorld;

 private:
  void predictUnconstraintMotion(btScalar dt) override {
    // NOLINTNEXTLINE(bugprone-parent-virtual-call): the parent also predicts the links
    btDiscreteDynamicsWorld::predictUnconstraintMotion(dt);
  }
};

// The table: the half-space below z = 0. Bullet's own plane has an infinite bounding box, so each step would
// test each link for contact.
class TablePlane final : public btStaticPlaneShape {
 public:
  TablePlane() : btStaticPlaneShape(btVector3(0, 0, 1), 0.0) {}

  void getAabb(const btTransform& X, btVector3& low, btVector3& high) const override {
    btStaticPlaneShape::getAabb(X, low, high);
    high.setZ(X.getOrigin().z() + getMargin());
  }
};

}  // namespace

struct BulletArm::Impl {
  // Bullet's parts. Later ones use earlier ones.
  btDefaultCollisionConfiguration collision_configuration;
  btCollisionDispatcher dispatcher{&collision_configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  RigidWorld world{&dispatcher, &broadphase, &solver, &collision_configuration};
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;
  std::vector<std::unique_ptr<btCollisionObject>> fixed;  // table and boxes
  std::unique_ptr<btMultiBody> body;
  std::vector<std::unique_ptr<btMultiBodyJointMotor>> stiction;  // one per moving joint; empty: no stiction
  Eigen::VectorXd coulomb;                                       // largest torques of `stiction`
  btVector3 upright_gravity = btVector3(0, 0, 0);                // in B, for a base that is not tilted
  double last_dt = 1.0;

  SimRobot robot;
  std::vector<PrincipalBody> principal;  // per link of the robot
  std::optional<MultiBodyJoints> joints;
  std::optional<Rotors> rotors;    // none: all inertias are 0
  Eigen::VectorXd rotor_stiction;  // torques of the last step, with rotors
  int load = -1;                   // Bullet's link for the load; -1: none
  Eigen::VectorXd q;
  Eigen::VectorXd dq;
  std::optional<Eigen::VectorXd> gravity_torque;  // at q; computed on the first request

  ~Impl() {
    for (const auto& motor : stiction) {
      world.removeMultiBodyConstraint(motor.get());
    }
    world.removeMultiBody(body.get());
    for (const auto& collider : colliders) {
      world.removeCollisionObject(collider.get());
    }
    for (const auto& object : fixed) {
      world.removeCollisionObject(object.get());
    }
  }

  void Build(const BulletArmOptions& options) {
    principal = PrincipalBodies(robot);
    const int num_links = static_cast<int>(robot.links.size()) - 1;
    load = options.may_be_loaded ? num_links : -1;
    body = std::make_unique<btMultiBody>(options.may_be_loaded ? num_links + 1 : num_links, 0.0,
                                         btVector3(0, 0, 0), /*fixedBase=*/true,
                                         /*canSleep=*/false);
    std::vector<int> dof_link(static_cast<std::size_t>(robot.num_dofs));  // Bullet's link of each joint
    Eigen::VectorXd inertia = Eigen::VectorXd::Zero(robot.num_dofs);      // of the rotors
    for (int i = 0; i < num_links; ++i) {
      SetUpLink(robot, principal, i, *body);
      if (const SimLink& link = robot.links[static_cast<std::size_t>(i + 1)]; link.dof >= 0) {
        dof_link[static_cast<std::size_t>(link.dof)] = i;
        inertia[link.dof] = link.rotor_inertia;
      }
    }
    if (load >= 0) {
      SetUpLoad(robot, principal, load, *body);
    }
    joints.emplace(*body, std::move(dof_link));
    if (!inertia.isZero(0.0)) {
      rotors.emplace(std::move(inertia), options.integrator, *joints);
    }
    body->setLinearDamping(0.0);
    body->setAngularDamping(0.0);
    body->setMaxCoordinateVelocity(1e6);
    body->setMaxAppliedImpulse(1e6);
    body->setHasSelfCollision(false);
    body->useRK4Integration(options.integrator == Integrator::kRungeKutta4 && !rotors);
    body->finalizeMultiDof();
    upright_gravity = btVector3(0, 0, options.gravity ? -kGravity : 0.0);
    world.setGravity(upright_gravity);
    world.addMultiBody(body.get());
    AddColliders();
    if (options.table) {
      AddFixed(std::make_unique<TablePlane>(), Eigen::Vector3d::Zero());
    }
    for (const Eigen::AlignedBox3d& box : options.boxes) {
      AddFixed(std::make_unique<btBoxShape>(ToBullet(Eigen::Vector3d(box.sizes())) * 0.5), box.center());
    }
    q.setZero(robot.num_dofs);
    dq.setZero(robot.num_dofs);
  }

  void AddFixed(std::unique_ptr<btCollisionShape> shape, const Eigen::Vector3d& p_B) {
    fixed.push_back(std::make_unique<btCollisionObject>());
    fixed.back()->setCollisionShape(shape.get());
    fixed.back()->setWorldTransform(btTransform(btQuaternion::getIdentity(), ToBullet(p_B)));
    world.addCollisionObject(fixed.back().get(), btBroadphaseProxy::StaticFilter,
                             btBroadphaseProxy::DefaultFilter);
    shapes.push_back(std::move(shape));
  }

  // The base always stands on the table, so it has no collider.
  void AddColliders() {
    for (int i = 0; i < static_cast<int>(robot.links.size()) - 1; ++i) {
      const auto k = static_cast<std::size_t>(i + 1);
      if (robot.links[k].collisions.empty()) {
        continue;
      }
      auto compound = std::make_unique<btCompoundShape>();
      for (const Shape& shape : robot.links[k].collisions) {
        shapes.push_back(MakeBulletShape(shape));
        compound->addChildShape(ToBullet(principal[k].X_PL * shape.X_LS), shapes.back().get());
      }
      auto collider = std::make_unique<btMultiBodyLinkCollider>(body.get(), i);
      collider->setCollisionShape(compound.get());
      shapes.push_back(std::move(compound));
      body->getLink(i).m_collider = collider.get();
      world.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter,
                               btBroadphaseProxy::StaticFilter);
      colliders.push_back(std::move(collider));
    }
  }

  // Bullet solves constraints only for bodies with a collider. This collider touches nothing.
  void AddEmptyCollider() {
    shapes.push_back(std::make_unique<btEmptyShape>());
    auto collider = std::make_unique<btMultiBodyLinkCollider>(body.get(), 0);
    collider->setCollisionShape(shapes.back().get());
    body->getLink(0).m_collider = collider.get();
    world.addCollisionObject(collider.get(), /*collisionFilterGroup=*/0, /*collisionFilterMask=*/0);
    colliders.push_back(std::move(collider));
  }

  void ReadState() {
    gravity_torque.reset();
    q = joints->q();
    dq = joints->dq();
  }

  // A step of Bullet under `tau`.
  void StepBullet(const Eigen::VectorXd& tau, double dt) {
    joints->AddTorque(tau);
    world.stepSimulation(dt, 0);
  }

  Eigen::Isometry3d LinkPose(int index) const {
    if (index == 0) {
      return Eigen::Isometry3d::Identity();
    }
    return ToEigen(body->getLink(index - 1).m_cachedWorldTransform) *
           principal[static_cast<std::size_t>(index)].X_PL;
  }
};

BulletArm::BulletArm(const SimRobot& robot, const BulletArmOptions& options)
    : impl_(std::make_unique<Impl>()) {
  impl_->robot = robot;
  impl_->Build(options);
  SetState(Eigen::VectorXd::Zero(robot.num_dofs), Eigen::VectorXd::Zero(robot.num_dofs));
}

BulletArm::~BulletArm() = default;

int BulletArm::num_dofs() const { return impl_->robot.num_dofs; }
const Eigen::VectorXd& BulletArm::q() const { return impl_->q; }
const Eigen::VectorXd& BulletArm::dq() const { return impl_->dq; }

void BulletArm::SetState(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) {
  impl_->joints->SetState(q, dq);
  impl_->ReadState();
}

// Models Coulomb friction by a motor with target speed 0 and at most this torque.
void BulletArm::SetStiction(const Eigen::VectorXd& coulomb) {
  Impl& m = *impl_;
  if (m.rotors) {
    m.rotors->SetStiction(coulomb);
    return;
  }
  m.coulomb = coulomb;
  if (m.colliders.empty()) {
    m.AddEmptyCollider();
  }
  for (int i = 0; i < num_dofs(); ++i) {
    m.stiction.push_back(std::make_unique<btMultiBodyJointMotor>(m.body.get(), m.joints->link(i),
                                                                 /*desiredVelocity=*/0.0,
                                                                 /*maxMotorImpulse=*/0.0));
    m.stiction.back()->finalizeMultiDof();
    m.world.addMultiBodyConstraint(m.stiction.back().get());
  }
}

Eigen::VectorXd BulletArm::StictionTorque() const {
  const Impl& m = *impl_;
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(num_dofs());
  if (m.rotor_stiction.size() > 0) {
    tau = m.rotor_stiction;
  }
  for (std::size_t i = 0; i < m.stiction.size(); ++i) {
    tau[static_cast<Eigen::Index>(i)] = m.stiction[i]->getAppliedImpulse(0) / m.last_dt;
  }
  return tau;
}

void BulletArm::TiltBase(double about_x, double about_y) {
  const double g = impl_->upright_gravity.length();
  const double down = g * std::cos(about_x);
  impl_->world.setGravity(
      btVector3(down * std::sin(about_y), -g * std::sin(about_x), -down * std::cos(about_y)));
}

void BulletArm::SetLoad(double mass) {
  if (impl_->load < 0) {
    throw std::logic_error("BulletArm::SetLoad: may_be_loaded is false");
  }
  impl_->body->getLink(impl_->load).m_mass = mass;
}

void BulletArm::Step(const Eigen::VectorXd& tau, double dt) {
  for (std::size_t i = 0; i < impl_->stiction.size(); ++i) {
    impl_->stiction[i]->setMaxAppliedImpulse(impl_->coulomb[static_cast<Eigen::Index>(i)] * dt);
  }
  impl_->last_dt = dt;
  if (impl_->rotors) {
    const RotorStep step = impl_->rotors->Plan(tau, impl_->world.getGravity(), dt);
    impl_->StepBullet(step.tau, dt);
    impl_->joints->SetState(impl_->joints->q() + step.shift, impl_->joints->dq());
    impl_->rotor_stiction = step.stiction;
  } else {
    impl_->StepBullet(tau, dt);
    // Except for the colliders, Bullet's poses are still those of the step's beginning.
    impl_->joints->PlaceLinks();
  }
  impl_->ReadState();
}

Eigen::VectorXd BulletArm::ForwardDynamics(const Eigen::VectorXd& tau) {
  Impl& m = *impl_;
  const btVector3 g = m.world.getGravity();
  return m.rotors ? m.rotors->Acceleration(tau, g) : m.joints->Acceleration(tau, g);
}

Eigen::MatrixXd BulletArm::InverseMass() { return impl_->joints->InverseMass(); }

Eigen::VectorXd BulletArm::GravityTorque() const {
  if (!impl_->gravity_torque) {
    impl_->gravity_torque = WeightOnJoints(*impl_->body, impl_->robot, impl_->upright_gravity);
  }
  return *impl_->gravity_torque;
}

Eigen::Isometry3d BulletArm::LinkPose(int index) const { return impl_->LinkPose(index); }

double BulletArm::Energy() const {
  // Entry i + 1 belongs to Bullet's link i, in its own frame, at its centre of mass.
  const int num_links = impl_->body->getNumLinks();
  std::vector<btVector3> omega(static_cast<std::size_t>(num_links + 1));
  std::vector<btVector3> velocity(omega.size());
  impl_->body->compTreeLinkVelocities(omega.data(), velocity.data());
  double energy = 0.0;
  for (int i = 0; i < num_links; ++i) {
    const btVector3& w = omega[static_cast<std::size_t>(i + 1)];
    const btVector3& v = velocity[static_cast<std::size_t>(i + 1)];
    energy += 0.5 * (impl_->body->getLinkMass(i) * v.length2() + w.dot(impl_->body->getLinkInertia(i) * w));
    const btVector3 p = impl_->body->getLink(i).m_cachedWorldTransform.getOrigin();
    energy -= impl_->body->getLinkMass(i) * impl_->world.getGravity().dot(p);
  }
  return energy + (impl_->rotors ? impl_->rotors->Energy() : 0.0);
}

void BulletArm::FindContacts() { impl_->world.performDiscreteCollisionDetection(); }

int BulletArm::Contacts() const {
  int contacts = 0;
  for (int i = 0; i < impl_->dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = impl_->dispatcher.getManifoldByIndexInternal(i);
    for (int j = 0; j < manifold->getNumContacts(); ++j) {
      const btManifoldPoint& point = manifold->getContactPoint(j);
      contacts += point.getDistance() < 0.0 || point.getAppliedImpulse() > 0.0 ? 1 : 0;
    }
  }
  return contacts;
}

}  // namespace fovea::sim
