// SPDX-License-Identifier: Apache-2.0
// An arm with rotors: accelerations against the servo's model, energy, order of the integrators, friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

// A shipped arm with rotors, in both programs' forms.
struct RotorArm {
  explicit RotorArm(const std::string& file, unsigned seed = 5)
      : robot(robots::LoadRobot(test::RobotsFolder() + file)),
        sim_robot(LoadSimRobot(robot.urdf, robot.base_link, robot.tip_link)) {
    test::RandomStates random(seed);
    for (int i = 0; i < robot.model.num_joints; ++i) {
      model::Joint& joint = robot.model.joints[static_cast<std::size_t>(i)];
      joint.rotor_inertia = i == 1 ? 0.0 : random.Uniform(0.01, 0.6);
      for (SimLink& link : sim_robot.links) {
        if (link.dof == i) {
          link.rotor_inertia = joint.rotor_inertia;
        }
      }
    }
  }
  robots::Robot robot;
  SimRobot sim_robot;
};

class RotorArmTest : public testing::TestWithParam<const char*> {};

// Forward dynamics and a step of Euler must return ddq for tau = ID(q, dq, ddq).
TEST_P(RotorArmTest, AcceleratesAsTheServosModelSays) {
  const RotorArm arm(GetParam());
  const model::ArmModel& model = arm.robot.model;
  BulletArm bullet(arm.sim_robot, {.table = false});
  test::RandomStates random(3);
  double forward = 0.0;
  double step = 0.0;
  for (int k = 0; k < 500; ++k) {
    const model::VecN q = random.Position(model);
    const model::VecN dq = random.Joints(model, 2.0);
    const model::VecN ddq = random.Joints(model, 10.0);
    model::ArmPoses poses;
    model::ComputePoses(model, q, poses);
    model::VecN tau;
    model::InverseDynamics(model, poses, dq, ddq, tau);
    bullet.SetState(q, dq);
    forward = std::max(forward, (bullet.ForwardDynamics(tau) - ddq).norm() / ddq.norm());
    EXPECT_LT((bullet.q() - q).norm() + (bullet.dq() - dq).norm(), 1e-14) << "the state is kept";
    constexpr double kStep = 1e-3;
    bullet.Step(tau, kStep);
    step = std::max(step, ((bullet.dq() - dq) / kStep - ddq).norm() / ddq.norm());
    EXPECT_LT((bullet.q() - q - kStep * bullet.dq()).norm(), 1e-12);
  }
  std::cout << "worst over 500 states: forward dynamics " << forward << ", a step " << step << " relative\n";
  EXPECT_LT(forward, 1e-12);
  EXPECT_LT(step, 5e-12);
}

INSTANTIATE_TEST_SUITE_P(Arms, RotorArmTest,
                         testing::Values("/panda.toml", "/ur5e.toml", "/puma560.toml", "/gantry.toml",
                                         "/../../../../tests/core/model/mixed_arm.urdf"));

struct Swing {
  Eigen::VectorXd q;
  Eigen::VectorXd dq;
  double drift = 0.0;  // share of the kinetic energy
};

// Swings freely without gravity.
Swing SwingFor(double time_s, double step_s, Integrator integrator) {
  const RotorArm arm("/panda.toml");
  BulletArm bullet(arm.sim_robot, {.integrator = integrator, .table = false, .gravity = false});
  Eigen::VectorXd q(7), dq(7);
  q << 0.0, -0.5, 0.3, -1.8, 0.2, 1.5, 0.4;
  dq << 0.5, -0.4, 0.6, 0.5, -0.7, 0.4, 0.8;
  bullet.SetState(q, dq);
  const double start = bullet.Energy();
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(7);
  for (int i = 0; i < static_cast<int>(std::lround(time_s / step_s)); ++i) {
    bullet.Step(none, step_s);
  }
  return {bullet.q(), bullet.dq(), std::fabs(bullet.Energy() - start) / start};
}

TEST(RotorArmEnergyTest, CountsTheRotors) {
  const RotorArm arm("/panda.toml");
  SimRobot without = arm.sim_robot;
  double rotors = 0.0;
  const Eigen::VectorXd dq = Eigen::VectorXd::LinSpaced(7, 0.2, 1.4);
  for (SimLink& link : without.links) {
    rotors += link.dof >= 0 ? 0.5 * link.rotor_inertia * dq[link.dof] * dq[link.dof] : 0.0;
    link.rotor_inertia = 0.0;
  }
  BulletArm with_rotors(arm.sim_robot, {});
  BulletArm links_only(without, {});
  with_rotors.SetState(dq, dq);
  links_only.SetState(dq, dq);
  EXPECT_GT(rotors, 0.3);
  EXPECT_NEAR(with_rotors.Energy() - links_only.Energy(), rotors, 1e-10);
}

TEST(RotorArmEnergyTest, FreeSwingKeepsItsEnergy) {
  for (const Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRungeKutta4}) {
    const bool rk4 = integrator == Integrator::kRungeKutta4;
    const Swing swing = SwingFor(5.0, 1e-3, integrator);
    std::cout << (rk4 ? "Runge-Kutta 4" : "semi-implicit Euler") << ": drift " << 100.0 * swing.drift
              << " % of the kinetic energy in 5 s\n";
    EXPECT_LT(swing.drift, rk4 ? 1e-11 : 0.03);
  }
}

// Half the step leaves a sixteenth of the error with Runge-Kutta 4, half of it with Euler.
TEST(RotorArmEnergyTest, IntegratorsHaveTheirOrders) {
  const Swing exact = SwingFor(0.4, 5e-4, Integrator::kRungeKutta4);
  const auto error = [&](double step_s, Integrator integrator) {
    const Swing swing = SwingFor(0.4, step_s, integrator);
    return (swing.q - exact.q).norm() + (swing.dq - exact.dq).norm();
  };
  const double fourth = error(0.02, Integrator::kRungeKutta4) / error(0.01, Integrator::kRungeKutta4);
  const double first =
      error(0.02, Integrator::kSemiImplicitEuler) / error(0.01, Integrator::kSemiImplicitEuler);
  std::cout << "the error falls by " << fourth << " and " << first << " with half the step\n";
  EXPECT_GT(fourth, 13.0);
  EXPECT_LT(fourth, 19.0);
  EXPECT_GT(first, 1.7);
  EXPECT_LT(first, 2.4);
}

// A slider of 16 kg with a rotor of 4 kg: 20 kg behind its friction.
TEST(RotorStictionTest, SliderRestsAndSlidesWithTheMassOfBoth) {
  SimRobot robot = LoadSimRobot(test::RobotsFolder() + "/slider.urdf", "slider_rail", "slider_cart");
  double mass = 4.0;
  for (SimLink& link : robot.links) {
    mass += link.mass;
    link.rotor_inertia = link.dof == 0 ? 4.0 : 0.0;
  }
  for (const Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRungeKutta4}) {
    BulletArm bullet(robot, {.integrator = integrator, .table = false});
    bullet.SetStiction(Eigen::VectorXd::Constant(1, 7.0));
    bullet.SetState(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1));
    const Eigen::VectorXd gravity = bullet.GravityTorque();
    constexpr double kStep = 1e-3;
    for (int k = 0; k < 50; ++k) {
      bullet.Step(gravity + Eigen::VectorXd::Constant(1, 6.99), kStep);
    }
    EXPECT_LT(std::fabs(bullet.dq()[0]), 1e-14);
    EXPECT_LT(std::fabs(bullet.q()[0]), 1e-14) << "a held joint does not creep";
    EXPECT_NEAR(bullet.StictionTorque()[0], -6.99, 1e-9);
    for (int k = 0; k < 50; ++k) {
      bullet.Step(gravity + Eigen::VectorXd::Constant(1, 9.0), kStep);
    }
    EXPECT_NEAR(bullet.StictionTorque()[0], -7.0, 1e-12);
    EXPECT_NEAR(bullet.dq()[0], 2.0 / mass * 50 * kStep, 1e-12);
    const double t = 50 * kStep;
    const double way = 0.5 * 2.0 / mass * t * (integrator == Integrator::kRungeKutta4 ? t : t + kStep);
    EXPECT_NEAR(bullet.q()[0], way, 1e-12);
  }
}

}  // namespace
}  // namespace fovea::sim
