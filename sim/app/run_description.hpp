// What a run is of: everything that follows from its scenario, checked and ready. Made once, then only read.
#pragma once

#include <optional>

#include "fovea/servo/servo_config.hpp"
#include "fovea/vision/intrinsics.hpp"
#include "sim/app/scenario.hpp"
#include "sim/app/theory_run.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/scene_renderer.hpp"

namespace fovea::sim {

struct RunDescription {
  Scenario scenario;
  robots::Robot robot;
  servo::ServoConfig servo;
  RenderScene scene;
  Pinhole pinhole;
  vision::Intrinsics intrinsics;  // of the same camera, as the vision task has them
  std::optional<CommandedMotion> motion;
  std::optional<TheoryConfig> theory;
};

// InputError when the scenario cannot be run.
RunDescription DescribeRun(const Scenario& scenario);

}  // namespace fovea::sim
