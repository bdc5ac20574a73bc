// What a run is of: everything that follows from its scenario, checked and ready. Made once, then only read.
#pragma once

#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/vision/pose/intrinsics.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/theory/run.hpp"

namespace fovea::sim {

struct RunDescription {
  Scenario scenario;
  robots::Robot robot;
  config::ServoConfig servo;
  RenderScene scene;
  Pinhole pinhole;
  vision::Intrinsics intrinsics;  // of the same camera, as the vision task has them
  std::optional<CommandedMotion> motion;
  std::optional<TheoryConfig> theory;
};

// InputError when the scenario cannot be run.
RunDescription DescribeRun(const Scenario& scenario);

}  // namespace fovea::sim
