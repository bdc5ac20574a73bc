// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/scenario_arm.hpp"

#include "firmware/host/config/input_error.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/realism.hpp"

namespace fovea::sim {

ScenarioArm LoadScenarioArm(const Scenario& scenario) {
  ScenarioArm arm;
  robots::Robot& robot = arm.robot;
  robot = LoadScenarioRobot(scenario);
  CheckRealism(scenario, robot);
  CheckSizes(scenario, robot);
  arm.unloaded = LoadSimRobot(robot.urdf, robot.base_link, robot.tip_link, robot.root);
  CheckFriction(scenario);
  CheckDrives(scenario.arm.drives, robot.model.num_joints);
  SetJoints(scenario, robot, arm.unloaded);
  CheckRotors(scenario.arm.drives, arm.unloaded);
  if (scenario.arm.integrator == "rk4" &&
      !MakeJointSprings(scenario.arm.drives, robot.model.num_joints).empty()) {
    throw config::InputError(
        "arm.integrator = \"rk4\" is not allowed with arm.joint_stiffness: elastic joints step with "
        "\"euler\"");
  }
  if (const model::Load load = config::MakeLoad(scenario.arm.load); load.mass > 0.0) {
    model::Attach(load, robot.model);
  }
  return arm;
}

}  // namespace fovea::sim
