#include "sim/app/verdict_config.hpp"

#include "sim/app/target_error.hpp"

namespace fovea::sim {

VerdictConfig MakeVerdictConfig(const RunDescription& about) {
  const servo::GuardConfig& guard = about.servo.guard;
  VerdictConfig config;
  config.barriers = {about.servo.arm, guard.workspace_radius, guard.cartesian_speed, guard.obstacles,
                     guard.hand};
  config.pinhole = about.pinhole;
  config.goal = GoalOf(about.servo.feature);
  config.has_eye = about.scenario.camera.enabled;
  if (about.motion && std::holds_alternative<CommandedCircle>(*about.motion)) {
    config.circle = std::get<CommandedCircle>(*about.motion);
  }
  config.goes_home = about.motion && std::holds_alternative<CommandedHome>(*about.motion);
  config.path_bound_mm = about.scenario.motion.bound_mm;
  config.target_moves = KeepsMoving(about.scenario.target);
  config.tracking_bound_px = about.scenario.run.tracking_bound_px;
  config.duration_s = about.scenario.run.duration_s;
  config.faults = FaultsOf(about.scenario.faults);
  return config;
}

}  // namespace fovea::sim
