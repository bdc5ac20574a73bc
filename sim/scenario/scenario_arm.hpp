// SPDX-License-Identifier: Apache-2.0
// The arm of a scenario, as its servo believes it is.
#pragma once

#include "firmware/host/robots/robot.hpp"
#include "sim/robot/sim_robot.hpp"
#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

struct ScenarioArm {
  robots::Robot robot;  // with the load of arm.load_*
  SimRobot unloaded;    // the same for the physics, without that load
};

// InputError: the arm cannot be loaded, or a key of [arm] does not fit it.
ScenarioArm LoadScenarioArm(const Scenario& scenario);

}  // namespace fovea::sim
