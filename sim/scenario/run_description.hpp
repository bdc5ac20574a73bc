// SPDX-License-Identifier: Apache-2.0
// Everything that a run derives from its scenario, complete and checked. Constant after DescribeRun.
#pragma once

#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/scenario/theory_config.hpp"

namespace fovea::sim {

struct RunDescription {
  Scenario scenario;
  robots::Robot robot;
  config::ServoConfig servo;
  RenderScene scene;
  Pinhole pinhole;
  vision::Intrinsics intrinsics;  // of the same camera, for the vision task
  std::optional<CommandedMotion> motion;
  std::optional<TheoryConfig> theory;
};

// InputError: the scenario cannot be run.
RunDescription DescribeRun(const Scenario& scenario);

}  // namespace fovea::sim
