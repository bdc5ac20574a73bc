// SPDX-License-Identifier: Apache-2.0
// The simulator's kinematics and dynamics compared with the servo's: independent code for the same URDF.
#include "sim/robot/chain.hpp"

#include <gtest/gtest.h>

#include <random>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {
namespace {

TEST(Chain, AgreesWithTheServosModel) {
  double pose = 0.0;
  double jacobian = 0.0;
  double mass = 0.0;
  double coriolis = 0.0;
  for (const char* name : {"panda", "ur5e", "puma560", "gantry"}) {
    robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/" + name + ".toml");
    sim::SimRobot links = sim::LoadSimRobot(robot.urdf, robot.base_link, robot.tip_link);
    for (sim::SimLink& link : links.links) {
      if (link.dof >= 0) {
        link.rotor_inertia = 0.1 * (1.0 + link.dof);
        robot.model.joints.at(static_cast<std::size_t>(link.dof)).rotor_inertia = link.rotor_inertia;
      }
    }
    const sim::Chain chain(links);
    ASSERT_EQ(chain.num_dofs(), robot.model.num_joints);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> even(-2.5, 2.5);
    for (int k = 0; k < 200; ++k) {
      Eigen::VectorXd q(chain.num_dofs());
      Eigen::VectorXd dq(chain.num_dofs());
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        q[i] = even(random);
        dq[i] = even(random);
      }
      model::ArmPoses poses;
      model::Mat6N J_B;
      model::ArmDynamics dynamics;
      model::ComputePoses(robot.model, q, poses);
      model::ComputeBaseJacobian(robot.model, poses, J_B);
      model::ComputeDynamics(robot.model, poses, dq, dynamics);
      sim::Jacobian J;
      const Eigen::Isometry3d X_BE = chain.TipPose(q, J);
      pose = std::max(pose, (X_BE.linear() - poses.X_BE.R).cwiseAbs().maxCoeff());
      pose = std::max(pose, (X_BE.translation() - poses.X_BE.p).cwiseAbs().maxCoeff());
      jacobian = std::max(jacobian, (J - J_B).cwiseAbs().maxCoeff());
      mass = std::max(mass, (chain.MassMatrix(q) - dynamics.M).cwiseAbs().maxCoeff());
      coriolis = std::max(coriolis, (chain.CoriolisTorque(q, dq) - dynamics.Cdq).cwiseAbs().maxCoeff());
    }
  }
  std::cout << "pose " << pose << ", Jacobian " << jacobian << ", M " << mass << " kg m^2, C dq " << coriolis
            << " Nm\n";
  EXPECT_LT(pose, 1e-14);
  EXPECT_LT(jacobian, 1e-14);
  EXPECT_LT(mass, 1e-13);
  EXPECT_LT(coriolis, 1e-12);
}

}  // namespace
}  // namespace fovea::test
