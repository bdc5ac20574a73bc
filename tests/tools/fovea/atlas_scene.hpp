// SPDX-License-Identifier: Apache-2.0
// The scene of an atlas, without asking the simulator for it.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "firmware/host/config/servo_keys.hpp"
#include "tests/support/panda.hpp"
#include "tools/fovea/atlas/scene.hpp"

namespace fovea::test {

// A shipped arm with the camera of the scenario `ball`, above its table.
inline atlas::Scene AtlasScene(const std::string& arm, const std::string& target) {
  config::ServoSettings settings;
  settings.planes = {0.0, 0.0, 1.0, 0.03};
  config::TargetSettings kind;
  kind.kind = target;
  atlas::Scene scene;
  const double f = 320.0 / std::tan(model::kPi / 6.0);
  scene.camera = {640, 480, f, f, 319.5, 239.5};
  const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/" + arm + ".toml");
  scene.drawn = std::make_shared<const atlas::DrawnArm>(robot);
  scene.servo = config::MakeServoConfig(settings, {arm, robot.model, {}}, DefaultMount(), scene.camera, kind);
  return scene;
}

}  // namespace fovea::test
