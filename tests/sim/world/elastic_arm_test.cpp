// SPDX-License-Identifier: Apache-2.0
// A Panda with elastic joints in the world: its rest, its sensors, friction on the motors, and the rigid arm
// as the limit of stiff joints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "fovea/hal/types.hpp"
#include "sim/world/world.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;

WorldConfig PandaWithRotors() {
  WorldConfig config;
  config.robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  for (SimLink& link : config.robot.links) {
    link.rotor_inertia = link.dof >= 0 ? 0.4 : 0.0;
  }
  config.q_start.resize(7);
  config.q_start << 0.0, -0.7, 0.0, -2.2, 0.0, 1.6, 0.7;
  return config;
}

WorldConfig ElasticPanda(double stiffness, double damping) {
  WorldConfig config = PandaWithRotors();
  config.joint_springs.assign(7, {stiffness, damping});
  return config;
}

// At rest the springs carry the weight; motors are ahead of the links by tau / K, and torque sensors read
// tau.
TEST(ElasticArmTest, RestsWithTheStaticDeflection) {
  for (const bool on_motor : {true, false}) {
    WorldConfig config = ElasticPanda(2e3, 10.0);
    config.encoder_on_motor = on_motor;
    World world(config);
    BulletArm links(config.robot, config.physics);
    links.SetState(world.truth().q, world.truth().dq);
    const Eigen::VectorXd weight = links.GravityTorque();
    const Eigen::VectorXd deflection = weight / 2e3;
    const Eigen::VectorXd expected = on_motor ? Eigen::VectorXd(config.q_start - deflection) : config.q_start;
    std::cout << "joint 2 carries " << weight[1] << " Nm and gives " << deflection[1] << " rad\n";
    EXPECT_GT(std::fabs(deflection[1]), 1e-3);
    EXPECT_LT((world.truth().q - expected).norm(), 1e-12);
    EXPECT_LT((world.Reading() - config.q_start).norm(), 1e-12) << "the encoders read arm.q_start";
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(world.MeasuredState().tau_meas[static_cast<std::size_t>(i)], weight[i], 1e-9);
    }
  }
}

// Without damping, under torques that change smoothly.
TEST(ElasticArmTest, GoesToTheRigidArmAsTheStiffnessGrows) {
  const auto run = [](const WorldConfig& config) {
    World world(config);
    std::vector<Eigen::VectorXd> path;
    for (int n = 0; n < 300; ++n) {
      hal::ArmCommand command;
      command.num_joints = 7;
      for (std::size_t i = 0; i < 7; ++i) {
        command.tau_cmd[i] = (i < 4 ? 3.0 : 0.3) * std::sin(0.03 * n + static_cast<double>(i));
      }
      world.Command(command);
      world.AdvanceTo(world.now_ns() + kMs);
      path.push_back(world.truth().q);
    }
    return path;
  };
  WorldConfig rigid_config = PandaWithRotors();
  rigid_config.friction_compensation = 1.0;  // friction acts on the motors, where it is smoothed otherwise
  const std::vector<Eigen::VectorXd> rigid = run(rigid_config);
  double before = 0.0;
  for (const double stiffness : {1e3, 1e4, 1e5, 1e6, 1e7}) {
    WorldConfig config = ElasticPanda(stiffness, 0.0);
    config.friction_compensation = 1.0;
    config.encoder_on_motor = false;
    const std::vector<Eigen::VectorXd> path = run(config);
    double worst = 0.0;
    for (std::size_t n = 0; n < path.size(); ++n) {
      worst = std::max(worst, (path[n] - rigid[n]).cwiseAbs().maxCoeff());
    }
    std::cout << stiffness << " Nm/rad: at most " << worst << " rad from the rigid arm\n";
    if (before > 0.0 && stiffness <= 1e5) {
      EXPECT_LT(worst, 0.15 * before);
    }
    before = worst;
    // Of stiffer springs, undamped swings faster than a tick remain.
    EXPECT_TRUE(stiffness < 1e6 || worst < 1e-5) << worst;
  }
}

// A pull at a link bends the spring of a motor that friction holds.
TEST(ElasticArmTest, FrictionHoldsTheMotorsNotTheLinks) {
  WorldConfig config = ElasticPanda(1e6, 1e3);
  config.joint_springs[0] = {1e3, 50.0};
  config.friction_compensation = 0.0;
  config.stiction = true;
  World world(config);
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(7);
  pull[0] = 0.2;  // friction of joint 1: 0.5 Nm, more than twice as much: the link swings beyond its rest
  world.PullAt(pull);
  world.AdvanceTo(3'000 * kMs);
  std::cout << "0.2 Nm turn link 1 by " << world.truth().q[0] << " rad, its motor by " << world.Reading()[0]
            << "\n";
  EXPECT_NEAR(world.truth().q[0], 0.2 / 1e3, 1e-6);
  EXPECT_NEAR(world.Reading()[0], 0.0, 1e-6);
  EXPECT_NEAR(world.MeasuredState().tau_meas[0], -0.2, 1e-3);
}

TEST(ElasticArmTest, BrakesStopMotorsAndLinks) {
  WorldConfig config = ElasticPanda(1e4, 10.0);
  config.dq_start = Eigen::VectorXd::Constant(7, 0.3);
  World world(config);
  hal::ArmCommand command;
  command.num_joints = 7;
  command.engage_brakes = true;
  world.Command(command);
  world.AdvanceTo(100 * kMs);
  EXPECT_EQ(world.truth().dq.norm(), 0.0);
  EXPECT_EQ(world.ReadingSpeed().norm(), 0.0);
}

// A world goes on from the readings that it is given.
TEST(ElasticArmTest, IsPlacedByItsReadings) {
  for (const bool on_motor : {true, false}) {
    WorldConfig config = ElasticPanda(1e4, 10.0);
    config.encoder_on_motor = on_motor;
    World world(config);
    World other(config);
    world.AdvanceTo(20 * kMs);
    other.AdvanceTo(20 * kMs);
    other.PlaceArm(Eigen::VectorXd(world.Reading()), Eigen::VectorXd(world.ReadingSpeed()));
    EXPECT_LT((other.Reading() - world.Reading()).norm(), 1e-14);
    world.AdvanceTo(40 * kMs);
    other.AdvanceTo(40 * kMs);
    EXPECT_LT((other.truth().q - world.truth().q).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace fovea::sim
