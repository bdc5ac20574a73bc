// SPDX-License-Identifier: Apache-2.0
// `fovea model` on the command line, and its generated C++ compared with the arm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "emitted/panda.hpp"
#include "emitted/slider.hpp"
#include "emitted/ur5e.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"
#include "tests/support/program.hpp"

namespace fovea {
namespace {

using nlohmann::json;
using testing::HasSubstr;

test::ProgramResult Model(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {FOVEA_PROGRAM, "model"});
  return test::RunProgram(arguments);
}

TEST(FoveaModel, TorqueEqualsMassTimesAccelerationPlusBias) {
  const test::ProgramResult run =
      Model({"panda", "--json", "--at", "0.1,-0.5,0.2,-2,0.3,1.7,0.4,1,-1,0.5,2,-2,1,3,5,-5,4,3,2,1,-1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json model = json::parse(run.out);
  for (const char* key : {"q", "dq", "ddq", "X_BE", "J_E", "M", "h", "g", "tau"}) {
    EXPECT_TRUE(model.contains(key)) << key;
  }
  EXPECT_EQ(model["dq"][0], 1.0);
  EXPECT_EQ(model["ddq"][6], -1.0);
  EXPECT_EQ(model["J_E"].size(), 6U);
  EXPECT_EQ(model["X_BE"].size(), 7U);
  double worst = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    double tau = model["h"][i];
    for (std::size_t j = 0; j < 7; ++j) {
      tau += model["M"][i][j].get<double>() * model["ddq"][j].get<double>();
    }
    worst = std::max(worst, std::fabs(tau - model["tau"][i].get<double>()));
    EXPECT_NE(model["h"][i], model["g"][i]);
  }
  std::cout << "M ddq + h differs from tau by " << worst << " Nm\n";
  EXPECT_LT(worst, 5e-14);
}

TEST(FoveaModel, DefaultStateIsTheReadyPostureAtRest) {
  const test::ProgramResult run = Model({"panda"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("p = (0.3069, 0.0000, 0.5903) m"));
  EXPECT_THAT(run.out, HasSubstr("checks over"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("BAD")));
}

TEST(FoveaModel, RefusesUnknownArmsAndBadNumbers) {
  EXPECT_THAT(Model({"nix"}).err, HasSubstr("unknown arm \"nix\"; shipped are gantry, panda, puma560"));
  EXPECT_THAT(Model({"pandda"}).err, HasSubstr("unknown arm \"pandda\"; did you mean panda?"));
  EXPECT_EQ(Model({"nix"}).exit_code, 2);
  EXPECT_THAT(Model({"panda", "--at", "1,2"}).err, HasSubstr("--at has 2 numbers: 7, 14 or 21 are allowed"));
  EXPECT_THAT(Model({"panda", "--at", "nan,0,0,0,0,0,0"}).err,
              HasSubstr("nan is not allowed: expected a finite number"));
  EXPECT_EQ(Model({"panda", "--json", "--emit-cpp"}).exit_code, 2);
}

void ExpectSame(const model::Pose& a, const model::Pose& b) {
  EXPECT_EQ(a.R, b.R);
  EXPECT_EQ(a.p, b.p);
}

void ExpectSame(const model::ArmModel& emitted, const model::ArmModel& read) {
  ASSERT_EQ(emitted.num_joints, read.num_joints);
  for (std::size_t k = 0; k < static_cast<std::size_t>(read.num_joints); ++k) {
    const model::Joint& a = emitted.joints[k];
    const model::Joint& b = read.joints[k];
    EXPECT_EQ(a.type, b.type);
    ExpectSame(a.X_PJ, b.X_PJ);
    EXPECT_EQ((std::array{a.q_min, a.q_max, a.dq_max, a.ddq_max, a.dddq_max, a.tau_max, a.dtau_max, a.viscous,
                          a.coulomb, a.rotor_inertia, a.spring}),
              (std::array{b.q_min, b.q_max, b.dq_max, b.ddq_max, b.dddq_max, b.tau_max, b.dtau_max, b.viscous,
                          b.coulomb, b.rotor_inertia, b.spring}));
    EXPECT_EQ(emitted.links[k].mass, read.links[k].mass);
    EXPECT_EQ(emitted.links[k].p_LiCom, read.links[k].p_LiCom);
    EXPECT_EQ(emitted.links[k].I_Com_Li, read.links[k].I_Com_Li);
    EXPECT_EQ(emitted.q_ready[k], read.q_ready[k]);
  }
  ExpectSame(emitted.X_LnE, read.X_LnE);
  EXPECT_EQ(emitted.g_B, read.g_B);
  for (std::size_t k = 0; k < read.shape.bodies.size(); ++k) {
    EXPECT_EQ(emitted.shape.bodies[k].p_LA, read.shape.bodies[k].p_LA);
    EXPECT_EQ(emitted.shape.bodies[k].p_LB, read.shape.bodies[k].p_LB);
    EXPECT_EQ(emitted.shape.bodies[k].radius, read.shape.bodies[k].radius);
  }
  ASSERT_EQ(emitted.shape.num_pairs, read.shape.num_pairs);
  for (std::size_t k = 0; k < static_cast<std::size_t>(read.shape.num_pairs); ++k) {
    EXPECT_EQ(emitted.shape.pairs[k].near, read.shape.pairs[k].near);
    EXPECT_EQ(emitted.shape.pairs[k].far, read.shape.pairs[k].far);
  }
}

TEST(FoveaModel, EmittedModelEqualsTheArmBitExact) {
  const auto read = [](const char* name) {
    return robots::LoadRobot(test::RobotsFolder() + "/" + name + ".toml").model;
  };
  model::ArmModel arm;
  arms::LoadPanda(arm);
  ExpectSame(arm, read("panda"));
  arms::LoadUr5e(arm);
  ExpectSame(arm, read("ur5e"));
  arms::LoadSlider(arm);
  ExpectSame(arm, read("slider"));
}

}  // namespace
}  // namespace fovea
