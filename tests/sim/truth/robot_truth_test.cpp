// SPDX-License-Identifier: Apache-2.0
// How an arm moves off that is not as its controller believes: against the servo's own model, joint by joint.
#include "sim/world/robot_truth.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
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

void ExpectEqual(const char* what, const Eigen::VectorXd& measured, const Eigen::VectorXd& computed,
                 double share = 1e-6) {
  const double off = (measured - computed).norm() / computed.norm();
  std::cout << what << ": first acceleration up to " << computed.cwiseAbs().maxCoeff()
            << " rad/s^2, off by a share of " << off << '\n';
  EXPECT_GT(computed.norm(), 0.05) << what;
  EXPECT_LT(off, share) << what;
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

TEST(RobotTruth, WrongRotorsAccelerateAsTheModelSays) {
  const Model heavy = ModelAtStart([](model::ArmModel& arm) {
    for (model::Joint& joint : arm.joints) {
      joint.rotor_inertia = 0.3;
    }
  });
  const Eigen::VectorXd bias = (Eigen::VectorXd(7) << 1.0, 0.0, -0.5, 0.2, 0.0, 0.1, -0.05).finished();
  const std::string pull = "truth.arm.torque_bias=[1.0, 0.0, -0.5, 0.2, 0.0, 0.1, -0.05]";
  ExpectEqual("rotors", FirstAcceleration({"truth.arm.rotor_inertia=0.3", pull}), heavy.M.ldlt().solve(bias));
  ExpectEqual("believed rotors", FirstAcceleration({"arm.rotor_inertia=[0.3,0.3,0.3,0.3,0.3,0.3,0.3]", pull}),
              heavy.M.ldlt().solve(bias));
}

// The sensors read what was commanded, so the servo's observer sees no external torque.
TEST(RobotTruth, SensorsReadTheCommandedTorque) {
  World honest(MakeWorldConfig(Described({})));
  World world(MakeWorldConfig(Described({"truth.arm.torque_scale=1.1", "truth.arm.torque_bias=0.3"})));
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(world.MeasuredState().tau_meas[i], honest.MeasuredState().tau_meas[i], 1e-12) << i;
  }
}

// The weight of the links on the joints at the start [Nm], by central differences of their potential energy,
// with the base tilted about its x and then its y axis [rad].
Eigen::VectorXd WeightOnTiltedBase(double about_x, double about_y) {
  const RunDescription run = Described({});
  const model::ArmModel& arm = run.servo.arm;
  const Eigen::Vector3d g_B = (Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()) *
                               Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()))
                                  .inverse() *
                              arm.g_B;
  const auto energy = [&](const model::VecN& q) {
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    double sum = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(arm.num_joints); ++i) {
      sum -= arm.links[i].mass * g_B.dot(poses.X_BL[i] * arm.links[i].p_LiCom);
    }
    return sum;
  };
  constexpr double kStep = 1e-5;
  Eigen::VectorXd weight(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    model::VecN q = Eigen::Map<const Eigen::VectorXd>(run.scenario.arm.q_start.data(), arm.num_joints);
    q[i] += kStep;
    const double above = energy(q);
    q[i] -= 2.0 * kStep;
    weight[i] = (above - energy(q)) / (2.0 * kStep);
  }
  return weight;
}

TEST(RobotTruth, ATiltedBasePullsAsThePotentialEnergySays) {
  const Model arm = ModelAtStart();
  for (const auto& [x, y] : {std::pair{2.0, 0.0}, std::pair{0.0, 2.0}, std::pair{-3.0, 5.0}}) {
    const Eigen::VectorXd weight =
        WeightOnTiltedBase(x * std::numbers::pi / 180.0, y * std::numbers::pi / 180.0);
    ExpectEqual("tilt", FirstAcceleration({fmt::format("truth.arm.base_tilt_deg=[{}, {}]", x, y)}),
                arm.M.ldlt().solve(arm.g - weight));
  }
}

// A moving joint keeps the friction that its controller does not know of. At 1 rad/s it is Coulomb's.
TEST(RobotTruth, UnknownFrictionBrakesInFull) {
  const auto moving = [](const std::string& truth) {
    std::vector<std::string> all{"arm.coulomb=[0,2,0,0,0,0,0]", "arm.viscous=[0,1,0,0,0,0,0]",
                                 "arm.friction_compensation=1", "arm.dq_start=[0,1,0,0,0,0,0]"};
    if (!truth.empty()) {
      all.push_back(truth);
    }
    World world(MakeWorldConfig(Described(all)));
    world.AdvanceTo(hal::kTickPeriodNs);
    return world.truth().dq;
  };
  const Eigen::VectorXd known = moving("");
  const Eigen::MatrixXd M = ModelAtStart().M;
  const Eigen::VectorXd joint_2 = Eigen::VectorXd::Unit(7, 1);
  ExpectEqual("2 Nm more", (moving("truth.arm.coulomb=[0,4,0,0,0,0,0]") - known) / hal::kTickPeriodS,
              M.ldlt().solve(-2.0 * joint_2), 1e-3);
  ExpectEqual("1 Nm less", (moving("truth.arm.coulomb=[0,1,0,0,0,0,0]") - known) / hal::kTickPeriodS,
              M.ldlt().solve(joint_2), 1e-3);
}

}  // namespace
}  // namespace fovea::sim
