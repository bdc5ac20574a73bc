// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/saved_scenario.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::sim {
namespace {

Truth SomeTruth() {
  Truth truth;
  truth.stamp_ns = 3'250'000'000;
  truth.q = (Eigen::VectorXd(7) << -0.31, -0.751234567890123, 0.01, -2.05, 0.1, 1.55, 0.485).finished();
  truth.dq = (Eigen::VectorXd(7) << 0.05, 0.0, -0.02, 0.0, 0.0, 0.0, 1.0 / 3.0).finished();
  truth.p_BO = {0.5, -0.1, 0.04};
  truth.R_BO =
      (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return truth;
}

class SavedScenarioTest : public testing::Test {
 protected:
  Scenario Reloaded(const std::string& text) {
    const std::filesystem::path file = folder_.path() / "saved.toml";
    std::ofstream(file) << text;
    return LoadScenario(file.string(), {});
  }
  test::TempFolder folder_;
};

TEST_F(SavedScenarioTest, BeginsAtThePresentState) {
  const Scenario scenario = LoadScenario("square", {"servo.lambda=1.5", "camera.noise_sigma=1.23456789"});
  PresentState present{SomeTruth(), true, {{"servo.lambda", 3.75}}, scenario.faults};
  present.faults.bench.load = {{1.0, 5.25}, 2.5};
  present.faults.bench.camera_outage = {0.5, 1.0};  // over
  const Scenario again = Reloaded(SaveScenario(DescribeRun(scenario), present));
  EXPECT_EQ(again.servo.config.law.lambda, 3.75);
  EXPECT_EQ(again.camera.noise_sigma, 1.23456789);
  EXPECT_EQ(again.faults.bench.load.window.start_s, 0.0);
  EXPECT_NEAR(again.faults.bench.load.window.end_s, 2.0, 1e-9);
  EXPECT_EQ(again.faults.bench.load.mass, 2.5);
  EXPECT_FALSE(again.faults.bench.camera_outage.Begins());
  const RunDescription run = DescribeRun(again);
  const World world(MakeWorldConfig(run));
  EXPECT_EQ(world.truth().q, present.truth.q) << "to the last bit";
  EXPECT_EQ(world.truth().dq, present.truth.dq);
  EXPECT_EQ(world.truth().p_BO, present.truth.p_BO);
  EXPECT_TRUE(world.truth().R_BO.isApprox(present.truth.R_BO, 1e-12));
}

// The start is what the encoders read, and the target's place is that of the believed ball.
TEST_F(SavedScenarioTest, BeginsAtThePresentStateWhereBeliefsAreWrong) {
  const Scenario scenario = LoadScenario(
      "ball", {"truth.arm.encoder_zero.sigma=0.01", "truth.target.size_scale.offset=0.1", "run.seed=3"});
  const PresentState present{SomeTruth(), true, {}, scenario.faults};
  const Scenario again = Reloaded(SaveScenario(DescribeRun(scenario), present));
  const World world(MakeWorldConfig(DescribeRun(again)));
  EXPECT_LT((world.truth().q - present.truth.q).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT((world.truth().p_BO - present.truth.p_BO).norm(), 1e-15);
}

// A key that stood beside a preset is saved even if it has its default.
TEST_F(SavedScenarioTest, KeepsAPresetWithItsExceptions) {
  const Scenario scenario = LoadScenario("ball", {"arm.realism=panda", "arm.torque_delay_ms=0"});
  const Scenario again =
      Reloaded(SaveScenario(DescribeRun(scenario), {SomeTruth(), true, {}, scenario.faults}));
  EXPECT_EQ(again.arm.rotor_inertia, scenario.arm.rotor_inertia);
  EXPECT_EQ(again.arm.encoder_quantum, scenario.arm.encoder_quantum);
  EXPECT_EQ(again.arm.drives.torque_ripple, scenario.arm.drives.torque_ripple);
  EXPECT_EQ(again.arm.drives.torque_bandwidth_hz, scenario.arm.drives.torque_bandwidth_hz);
  EXPECT_EQ(again.arm.drives.torque_delay_ms, 0.0);
}

TEST_F(SavedScenarioTest, AMovingTargetBeginsItsPathAnew) {
  const Scenario scenario = LoadScenario("ball-moving", {});
  const std::string text = SaveScenario(DescribeRun(scenario), {SomeTruth(), false, {}, scenario.faults});
  EXPECT_NE(text.find("# The target's path begins anew."), std::string::npos);
  const Scenario again = Reloaded(text);
  EXPECT_EQ(again.target.motion, scenario.target.motion);
  EXPECT_EQ(again.target.position, scenario.target.position);
  const Scenario touched =
      Reloaded(SaveScenario(DescribeRun(scenario), {SomeTruth(), true, {}, scenario.faults}));
  EXPECT_EQ(touched.target.motion, "still");
  EXPECT_EQ(touched.target.position[1], -0.1);
}

TEST_F(SavedScenarioTest, SurvivesQuotesInItsName) {
  Scenario scenario = LoadScenario("ball", {});
  scenario.name = "my \"best\" ball \\ 1";
  const Scenario again =
      Reloaded(SaveScenario(DescribeRun(scenario), {SomeTruth(), true, {}, scenario.faults}));
  EXPECT_NE(again.run.description.find(scenario.name), std::string::npos);
}

// Every shipped scenario can be saved and read again.
TEST_F(SavedScenarioTest, EachShippedScenarioComesBack) {
  for (const std::string& name : ShippedScenarios()) {
    const Scenario scenario = LoadScenario(name, {});
    const RunDescription about = DescribeRun(scenario);
    const Eigen::VectorXd readings = Eigen::Map<const Eigen::VectorXd>(
        scenario.arm.q_start.data(), static_cast<Eigen::Index>(scenario.arm.q_start.size()));
    PresentState present{SomeTruth(), false, {}, scenario.faults};
    present.truth.stamp_ns = 0;
    present.truth.dq = Eigen::VectorXd::Zero(readings.size());
    const Eigen::VectorXd& zero = about.robot_truth.encoder_zero;
    present.truth.q = zero.size() > 0 ? Eigen::VectorXd(readings - zero) : readings;
    Scenario again = Reloaded(SaveScenario(about, present));
    ASSERT_EQ(again.arm.q_start.size(), scenario.arm.q_start.size()) << name;
    for (std::size_t i = 0; i < again.arm.q_start.size(); ++i) {
      EXPECT_NEAR(again.arm.q_start[i], scenario.arm.q_start[i], 1e-15) << name;
    }
    Scenario before = scenario;
    std::map<std::string, std::string> values = ScenarioKeys(again).Values();
    std::map<std::string, std::string> wanted = ScenarioKeys(before).Values();
    for (const char* changed :
         {"run.description", "target.position", "target.rpy_deg", "arm.q_start", "arm.dq_start"}) {
      values.erase(changed);
      wanted.erase(changed);
    }
    EXPECT_EQ(values, wanted) << name;
  }
}

TEST_F(SavedScenarioTest, RefusesATunedKeyThatNoScenarioHas) {
  const Scenario scenario = LoadScenario("ball", {});
  EXPECT_NE(test::InputErrorOf([&] {
              static_cast<void>(SaveScenario(DescribeRun(scenario),
                                             {SomeTruth(), true, {{"servo.lamda", 1.0}}, scenario.faults}));
            }).find("did you mean servo.lambda"),
            std::string::npos);
}

}  // namespace
}  // namespace fovea::sim
