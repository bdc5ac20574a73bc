// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/config.hpp"

#include "firmware/core/trajectory/joint_pace.hpp"
#include "sim/verdict/target_error.hpp"

namespace fovea::sim {

VerdictConfig MakeVerdictConfig(const RunDescription& about) {
  const config::GuardConfig& guard = about.servo.guard;
  VerdictConfig config;
  config.barriers = {about.servo.arm,         guard.workspace_radius, guard.cartesian_speed,
                     guard.rotation_speed,    guard.obstacles,        guard.hand,
                     about.scene.bench->boxes};
  const int n = about.servo.arm.num_joints;
  config.stop.brake_after_s = about.servo.safety.brake_after_s;
  config.stop.ddq_max.resize(n);
  config.stop.dddq_max.resize(n);
  for (int i = 0; i < n; ++i) {
    const trajectory::JointPace pace = trajectory::PaceOf(about.servo, i);
    config.stop.ddq_max[i] = pace.ddq_max;
    config.stop.dddq_max[i] = pace.dddq_max;
  }
  config.eye = JudgedEyeOf(about);
  config.goal = GoalOf(about.servo.feature);
  config.has_eye = about.scenario.camera.enabled;
  config.has_motion = about.motion.has_value();
  if (about.motion && std::holds_alternative<CommandedCircle>(*about.motion)) {
    config.circle = std::get<CommandedCircle>(*about.motion);
  }
  config.goes_home = about.motion && std::holds_alternative<CommandedHome>(*about.motion);
  config.path_bound_mm = about.scenario.motion.bound_mm;
  config.target_moves = KeepsMoving(about.scenario.target);
  config.tracking_bound_px = about.scenario.run.tracking_bound_px;
  config.tracking_bound_mm = about.scenario.run.tracking_bound_mm;
  config.duration_s = about.scenario.run.duration_s;
  config.faults = FaultsOf(about.scenario.faults);
  return config;
}

}  // namespace fovea::sim
