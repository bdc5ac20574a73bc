// SPDX-License-Identifier: Apache-2.0
// Bullet's forward dynamics compared with our inverse dynamics, and conservation of energy.
#include "sim/physics/bullet_arm.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

class BulletArmTest : public testing::TestWithParam<const char*> {
 protected:
  BulletArmTest()
      : robot_(robots::LoadRobot(test::RobotsFolder() + GetParam())),
        sim_robot_(LoadSimRobot(robot_.urdf, robot_.base_link, robot_.tip_link)) {
    for (SimLink& link : sim_robot_.links) {
      link.rotor_inertia =
          link.dof < 0 ? 0.0 : robot_.model.joints[static_cast<std::size_t>(link.dof)].rotor_inertia;
    }
  }

  robots::Robot robot_;
  SimRobot sim_robot_;
  test::RandomStates random_{3};
};

// Bullet must return ddq for tau = ID(q, dq, ddq).
TEST_P(BulletArmTest, ForwardDynamicsInvertsOurInverseDynamics) {
  const model::ArmModel& arm = robot_.model;
  BulletArm bullet(sim_robot_, {.table = false});
  double worst_relative = 0.0;
  double worst_pose = 0.0;
  double worst_gravity = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const model::VecN q = random_.Position(arm);
    const model::VecN dq = random_.Joints(arm, 2.0);
    const model::VecN ddq = random_.Joints(arm, 10.0);
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    model::VecN tau;
    model::InverseDynamics(arm, poses, dq, ddq, tau);
    bullet.SetState(q, dq);
    const Eigen::VectorXd ddq_bullet = bullet.ForwardDynamics(tau);
    worst_relative = std::max(worst_relative, (ddq_bullet - ddq).norm() / ddq.norm());

    const Eigen::Isometry3d X_BE = bullet.LinkPose(sim_robot_.tip);
    worst_pose = std::max(worst_pose, (X_BE.translation() - poses.X_BE.p).cwiseAbs().maxCoeff());
    worst_pose = std::max(worst_pose, (X_BE.linear() - poses.X_BE.R).cwiseAbs().maxCoeff());

    model::ArmDynamics dynamics;
    model::ComputeDynamics(arm, poses, dq, dynamics);
    worst_gravity = std::max(worst_gravity, (bullet.GravityTorque() - dynamics.g).cwiseAbs().maxCoeff());
  }
  std::cout << "worst over 2000 states: ddq " << worst_relative << " relative, pose " << worst_pose
            << ", gravity " << worst_gravity << " Nm\n";
  EXPECT_LT(worst_relative, 1e-8);
  EXPECT_LT(worst_pose, 1e-12);
  EXPECT_LT(worst_gravity, 1e-10);
}

// At 0.2 m/s a link pose that is 1 ms old would be off by 0.2 mm.
TEST_P(BulletArmTest, LinkPosesMatchTheJointsAfterEachStep) {
  const model::ArmModel& arm = robot_.model;
  BulletArm bullet(sim_robot_, {.table = false});
  bullet.SetState(random_.Position(arm), random_.Joints(arm, 1.0));
  double worst_pose = 0.0;
  double worst_gravity = 0.0;
  double fastest = 0.0;
  for (int k = 0; k < 200; ++k) {
    bullet.Step(Eigen::VectorXd::Zero(arm.num_joints), 1e-3);
    model::ArmPoses poses;
    model::ComputePoses(arm, bullet.q(), poses);
    model::ArmDynamics dynamics;
    model::ComputeDynamics(arm, poses, bullet.dq(), dynamics);
    const Eigen::Isometry3d X_BE = bullet.LinkPose(sim_robot_.tip);
    worst_pose = std::max(worst_pose, (X_BE.translation() - poses.X_BE.p).cwiseAbs().maxCoeff());
    worst_pose = std::max(worst_pose, (X_BE.linear() - poses.X_BE.R).cwiseAbs().maxCoeff());
    worst_gravity = std::max(worst_gravity, (bullet.GravityTorque() - dynamics.g).cwiseAbs().maxCoeff());
    fastest = std::max(fastest, bullet.dq().cwiseAbs().maxCoeff());
  }
  std::cout << "worst over 200 steps, joints up to " << fastest << " rad/s: pose " << worst_pose
            << ", gravity " << worst_gravity << " Nm\n";
  EXPECT_GT(fastest, 0.3);
  EXPECT_LT(worst_pose, 1e-12);
  EXPECT_LT(worst_gravity, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Arms, BulletArmTest,
                         testing::Values("/panda.toml", "/ur5e.toml", "/puma560.toml", "/gantry.toml",
                                         "/../../../../tests/core/model/mixed_arm.urdf"));

// The arm falls onto a box under its elbow and stays on it.
TEST(BulletArmBoxTest, ArmTouchesABoxAndIsHeldByIt) {
  const SimRobot robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  const Eigen::VectorXd q = (Eigen::VectorXd(7) << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785).finished();
  const auto fall = [&](const std::vector<Eigen::AlignedBox3d>& boxes, int& contacts) {
    BulletArm bullet(robot, {.table = false, .boxes = boxes});
    bullet.SetState(q, Eigen::VectorXd::Zero(robot.num_dofs));
    bullet.FindContacts();
    EXPECT_EQ(bullet.Contacts(), 0);
    contacts = 0;
    for (int i = 0; i < 1500; ++i) {
      bullet.Step(-5.0 * bullet.dq(), 1e-3);
      contacts += bullet.Contacts();
    }
    return bullet.LinkPose(robot.tip).translation().z();
  };
  int contacts = 0;
  const double free = fall({}, contacts);
  EXPECT_EQ(contacts, 0);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(0.1, -0.2, 0.0), Eigen::Vector3d(0.9, 0.2, 0.25));
  const double held = fall({box}, contacts);
  std::cout << "the flange falls to " << free << " m, on the box to " << held << " m\n";
  EXPECT_GT(contacts, 100);
  EXPECT_GT(held, 0.2);
  EXPECT_LT(free, 0.0);
}

// A free swing without gravity must keep its energy. The figures show which integrator to use.
TEST(BulletArmEnergyTest, FreeSwingKeepsItsEnergy) {
  const std::string panda = test::RobotsFolder() + "/panda.urdf";
  const SimRobot robot = LoadSimRobot(panda, "panda_base", "panda_flange");
  for (const Integrator integrator : {Integrator::kSemiImplicitEuler, Integrator::kRungeKutta4}) {
    BulletArm bullet(robot, {.integrator = integrator, .table = false, .gravity = false});
    Eigen::VectorXd q(7), dq(7);
    q << 0.0, -0.5, 0.3, -1.8, 0.2, 1.5, 0.4;
    dq << 0.5, -0.4, 0.6, 0.5, -0.7, 0.4, 0.8;
    bullet.SetState(q, dq);
    const double start = bullet.Energy();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(7);
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 5000; ++i) {
      bullet.Step(none, 1e-3);
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
    const double drift = std::abs(bullet.Energy() - start) / start;
    const bool rk4 = integrator == Integrator::kRungeKutta4;
    std::cout << (rk4 ? "Runge-Kutta 4" : "semi-implicit Euler") << ": drift " << 100.0 * drift
              << " % of the kinetic energy in 5 s, " << took.count() / 5000.0 << " us per step\n";
    EXPECT_LT(drift, rk4 ? 1e-8 : 0.03);
  }
}

}  // namespace
}  // namespace fovea::sim
