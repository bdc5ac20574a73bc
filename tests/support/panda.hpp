// SPDX-License-Identifier: Apache-2.0
// The Panda and its servo configuration, as most tests use them.
#pragma once

#include <string>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/math.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"

namespace fovea::test {

inline const robots::Robot& Panda() {
  static const robots::Robot robot = robots::LoadRobot(test::RobotsFolder() + "/panda.toml");
  return robot;
}

// The default camera mount: +90 degrees about z, (0.05, 0, 0.04) m.
inline model::Pose DefaultMount() {
  model::Pose X_EC;
  X_EC.R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  X_EC.p = {0.05, 0.0, 0.04};
  return X_EC;
}

inline config::ServoConfig PandaConfig() {
  config::ServoConfig config;
  config.arm = Panda().model;
  config.X_EC = DefaultMount();
  config.law.q_posture = config.arm.q_ready;
  config.auto_track = true;
  return config;
}

inline model::VecN Ready() { return model::ToVector(Panda().model.q_ready, Panda().model.num_joints); }

}  // namespace fovea::test
