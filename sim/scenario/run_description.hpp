// SPDX-License-Identifier: Apache-2.0
// Everything that a run derives from its scenario, complete and checked. Constant after DescribeRun.
#pragma once

#include <optional>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/planning/eye_reach.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "sim/camera/lens.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/theory_config.hpp"
#include "sim/truth/truth_draw.hpp"
#include "sim/world/robot_truth.hpp"
#include "sim/world/true_stamps.hpp"

namespace fovea::sim {

// A camera on the end effector.
struct EyeGeometry {
  Pinhole pinhole;
  Lens lens;
  Eigen::Isometry3d X_EC = Eigen::Isometry3d::Identity();
};

struct RunDescription {
  // What the servo believes.
  Scenario scenario;
  robots::Robot robot;
  config::ServoConfig servo;
  Pinhole pinhole;
  Lens lens;
  vision::Intrinsics intrinsics;  // of the same camera, for the vision task
  planning::EyeReach reach;       // of its detector

  // What is true: the same, except where the scenario's [truth] says otherwise.
  Scenario bench;
  RenderScene scene;
  EyeGeometry eye;
  double target_scale = 1.0;  // true size of the target over the believed one
  RobotTruth robot_truth;
  TrueStamps stamps;
  std::vector<TrueValue> truth;  // the values that differ

  std::optional<CommandedMotion> motion;
  std::optional<TheoryConfig> theory;
};

// InputError: the scenario cannot be run.
RunDescription DescribeRun(const Scenario& scenario);

}  // namespace fovea::sim
