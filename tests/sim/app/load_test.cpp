// SPDX-License-Identifier: Apache-2.0
// The load: the servo's model and the physics' bodies agree.
#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/host/config/input_error.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "sim/scenario/run_description.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

Scenario Carrying(double mass, const std::vector<double>& inertia) {
  Scenario scenario;
  scenario.arm.load.mass = mass;
  scenario.arm.load.com = {0.03, -0.05, 0.11};
  scenario.arm.load.inertia = inertia;
  return scenario;
}

TEST(LoadTest, ServoAndPhysicsCarryTheSameLoad) {
  const RunDescription run = DescribeRun(Carrying(1.7, {0.012, 0.015, 0.010, 0.001, -0.002, 0.003}));
  const RunDescription empty = DescribeRun(Carrying(0.0, {0.0, 0.0, 0.0}));
  const model::ArmModel& arm = run.servo.arm;
  BulletArm bullet(run.scene.robot, {.table = false});
  test::RandomStates random(5);
  double worst_relative = 0.0;
  double worst_gravity = 0.0;
  double most_weight = 0.0;
  for (int k = 0; k < 500; ++k) {
    const model::VecN q = random.Position(arm);
    const model::VecN dq = random.Joints(arm, 2.0);
    const model::VecN ddq = random.Joints(arm, 10.0);
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    model::VecN tau;
    model::InverseDynamics(arm, poses, dq, ddq, tau);
    bullet.SetState(q, dq);
    worst_relative = std::max(worst_relative, (bullet.ForwardDynamics(tau) - ddq).norm() / ddq.norm());
    model::ArmDynamics dynamics;
    model::ComputeDynamics(arm, poses, dq, dynamics);
    worst_gravity = std::max(worst_gravity, (bullet.GravityTorque() - dynamics.g).cwiseAbs().maxCoeff());
    model::ArmDynamics of_empty;
    model::ComputeDynamics(empty.servo.arm, poses, dq, of_empty);
    most_weight = std::max(most_weight, (dynamics.g - of_empty.g).cwiseAbs().maxCoeff());
  }
  std::cout << "ddq off by " << worst_relative << " (relative), gravity by " << worst_gravity
            << " Nm; the load's weight adds up to " << most_weight << " Nm\n";
  EXPECT_LT(worst_relative, 1e-12);
  EXPECT_LT(worst_gravity, 1e-12);
  EXPECT_GT(most_weight, 5.0);
}

TEST(LoadTest, LoadWithImpossibleInertiaIsRefused) {
  EXPECT_NO_THROW(DescribeRun(Carrying(1.0, {0.0, 0.0, 0.0}))) << "a point mass is allowed";
  EXPECT_THROW(DescribeRun(Carrying(1.0, {0.001, 0.001, 0.003})), config::InputError);
  EXPECT_THROW(DescribeRun(Carrying(1.0, {0.001, 0.001, 0.001, 0.002, 0.0, 0.0})), config::InputError);
  EXPECT_THROW(DescribeRun(Carrying(1.0, {0.001, 0.001, 0.001, 0.0})), config::InputError);
}

}  // namespace
}  // namespace fovea::sim
