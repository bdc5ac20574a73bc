// SPDX-License-Identifier: Apache-2.0
// How an arm moves off that is not as its controller believes: against the servo's own model, joint by joint.
#include "sim/world/robot_truth.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/core/model/dynamics.hpp"
#include "fovea/hal/types.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {
namespace {

RunDescription Described(std::vector<std::string> assignments) {
  assignments.insert(assignments.begin(), {"arm.velocity_noise=0", "arm.encoder_noise=0", "arm.load_mass=0"});
  return DescribeRun(LoadScenario("ball", assignments));
}

// The arm's first acceleration under command 0 [rad/s^2].
Eigen::VectorXd FirstAcceleration(const std::vector<std::string>& assignments) {
  World world(MakeWorldConfig(Described(assignments)));
  world.AdvanceTo(hal::kTickPeriodNs);
  return world.truth().dq / hal::kTickPeriodS;
}

// The mass matrix and weight of the servo's model at the start, with its links changed.
struct Model {
  Eigen::MatrixXd M;
  Eigen::VectorXd g;
};
Model ModelAtStart(const std::function<void(model::ArmModel&)>& change = {}) {
  const RunDescription run = Described({});
  model::ArmModel arm = run.servo.arm;
  if (change) {
    change(arm);
  }
  const std::vector<double>& q_start = run.scenario.arm.q_start;
  const model::VecN q =
      Eigen::Map<const Eigen::VectorXd>(q_start.data(), static_cast<Eigen::Index>(q_start.size()));
  model::ArmPoses poses;
  model::ComputePoses(arm, q, poses);
  model::ArmDynamics dynamics;
  model::ComputeDynamics(arm, poses, model::VecN::Zero(arm.num_joints), dynamics);
  return {dynamics.M, dynamics.g};
}

void ExpectEqual(const char* what, const Eigen::VectorXd& measured, const Eigen::VectorXd& computed) {
  const double off = (measured - computed).norm() / computed.norm();
  std::cout << what << ": first acceleration up to " << computed.cwiseAbs().maxCoeff()
            << " rad/s^2, off by a share of " << off << '\n';
  EXPECT_GT(computed.norm(), 0.05) << what;
  EXPECT_LT(off, 1e-6) << what;
}

TEST(RobotTruth, RightBeliefsCarryTheWeight) { EXPECT_LT(FirstAcceleration({}).norm(), 1e-6); }

TEST(RobotTruth, WrongMassesAndCentresPullAsTheModelSays) {
  const Model believed = ModelAtStart();
  const Model heavy = ModelAtStart([](model::ArmModel& arm) {
    for (int i = 0; i < arm.num_joints; ++i) {
      model::LinkInertia& link = arm.links[static_cast<std::size_t>(i)];
      link.mass *= 1.2;
      link.I_Com_Li *= 1.2;
    }
  });
  ExpectEqual("masses", FirstAcceleration({"truth.arm.link_mass.scale=1.2"}),
              heavy.M.ldlt().solve(believed.g - heavy.g));
  const model::Vec3 shift(0.01, -0.02, 0.03);  // of link 4
  const Model shifted = ModelAtStart([&](model::ArmModel& arm) { arm.links[3].p_LiCom += shift; });
  ExpectEqual("centre",
              FirstAcceleration(
                  {"truth.arm.link_com_shift=[0,0,0, 0,0,0, 0,0,0, 0.01,-0.02,0.03, 0,0,0, 0,0,0, 0,0,0]"}),
              shifted.M.ldlt().solve(believed.g - shifted.g));
}

TEST(RobotTruth, WrongTorquesAccelerateAsTheModelSays) {
  const Model arm = ModelAtStart();
  const Eigen::VectorXd scale = (Eigen::VectorXd(7) << 1.1, 1.1, 0.9, 1.2, 1.0, 0.8, 1.05).finished();
  const Eigen::VectorXd bias = (Eigen::VectorXd(7) << 1.0, 0.0, -0.5, 0.2, 0.0, 0.1, -0.05).finished();
  ExpectEqual("torques",
              FirstAcceleration({"truth.arm.torque_scale=[1.1, 1.1, 0.9, 1.2, 1.0, 0.8, 1.05]",
                                 "truth.arm.torque_bias=[1.0, 0.0, -0.5, 0.2, 0.0, 0.1, -0.05]"}),
              arm.M.ldlt().solve(scale.cwiseProduct(arm.g) + bias - arm.g));
}

// The sensors read what was commanded, so the servo's observer sees no external torque.
TEST(RobotTruth, SensorsReadTheCommandedTorque) {
  World honest(MakeWorldConfig(Described({})));
  World world(MakeWorldConfig(Described({"truth.arm.torque_scale=1.1", "truth.arm.torque_bias=0.3"})));
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(world.MeasuredState().tau_meas[i], honest.MeasuredState().tau_meas[i], 1e-12) << i;
  }
}

// A base that is turned about its x axis by a positive angle has its weight along -y. With the arm along x,
// joint 1, about z, therefore turns backwards. About y the weight is along x; with the arm along y, joint 1
// turns backwards, too.
TEST(RobotTruth, ATiltedBaseTurnsTheFirstJoint) {
  const auto turned = [](double q1) {
    return fmt::format("arm.q_start=[{}, -0.75, 0, -2.05, 0, 1.55, 0.485398]", q1);
  };
  const Eigen::VectorXd about_x = FirstAcceleration({"truth.arm.base_tilt_deg=[2, 0]", turned(0.0)});
  const Eigen::VectorXd about_y =
      FirstAcceleration({"truth.arm.base_tilt_deg=[0, 2]", turned(0.5 * std::numbers::pi)});
  EXPECT_LT(about_x[0], -0.05);
  EXPECT_LT((about_x - about_y).norm(), 1e-6 * about_x.norm());
  EXPECT_GT(FirstAcceleration({"truth.arm.base_tilt_deg=[-2, 0]", turned(0.0)})[0], 0.05);
}

// A moving joint keeps the friction that its controller does not know of.
TEST(RobotTruth, UnknownFrictionBrakesInFull) {
  const auto moving = [](const std::string& truth) {
    std::vector<std::string> all{"arm.coulomb=[0,2,0,0,0,0,0]", "arm.viscous=[0,1,0,0,0,0,0]",
                                 "arm.friction_compensation=1", "arm.dq_start=[0,0.2,0,0,0,0,0]"};
    if (!truth.empty()) {
      all.push_back(truth);
    }
    World world(MakeWorldConfig(Described(all)));
    world.AdvanceTo(hal::kTickPeriodNs);
    return world.truth().dq[1];
  };
  const double known = moving("");
  const double brake = known - moving("truth.arm.coulomb=[0,4,0,0,0,0,0]");
  const double push = moving("truth.arm.coulomb=[0,1,0,0,0,0,0]") - known;
  EXPECT_GT(brake, 0.0);
  EXPECT_NEAR(push, 0.5 * brake, 0.01 * brake) << "half as much is compensated too much";
}

}  // namespace
}  // namespace fovea::sim
