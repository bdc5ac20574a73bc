// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/world_config.hpp"

#include <vector>

#include "sim/scenario/compose.hpp"
#include "sim/scenario/solids.hpp"
#include "sim/scenario/to_vector.hpp"

namespace fovea::sim {

void SetArm(const Scenario& s, WorldConfig& config) {
  config.physics.integrator =
      s.arm.integrator == "rk4" ? Integrator::kRungeKutta4 : Integrator::kSemiImplicitEuler;
  config.q_start = ToVectorX(s.arm.q_start);
  config.dq_start = ToVectorX(s.arm.dq_start);
  config.spring = ToVectorX(s.arm.spring);
  config.stiction = s.arm.stiction;
  config.friction_compensation = s.arm.friction_compensation;
  config.encoder_noise = s.arm.encoder_noise;
  config.encoder_quantum = s.arm.encoder_quantum;
  config.velocity_noise = s.arm.velocity_noise;
  config.velocity_filter_hz = s.arm.drives.velocity_filter_hz;
  config.joint_springs = MakeJointSprings(s.arm.drives, config.robot.num_dofs);
  config.encoder_on_motor = s.arm.drives.encoder_side == "motor";
  config.drives = MakeDrives(s.arm.drives, config.robot.num_dofs, SeedOf(s, RandomStream::kDrives));
}

WorldConfig MakeWorldConfig(const RunDescription& run) {
  const Scenario& s = run.bench;
  WorldConfig config;
  config.robot = run.scene.robot;
  config.robot_truth = run.robot_truth;
  SetArm(s, config);
  config.X_EC = run.eye.X_EC;
  config.physics.boxes = BenchBoxes(s);
  config.target = MakeTargetMotion(s.target, SeedOf(s, RandomStream::kTarget));
  if (s.camera.enabled) {
    config.target_body = MakeTargetBody(MakeTargetShape(config::MakeTarget(s.target)));
  }
  config.ball = MakeRollingBall(s.target);
  config.ball_push = {s.target.push[0], s.target.push[1], s.target.push[2]};
  config.ball_push_s = s.target.push_s;
  config.camera_rate_hz = s.camera.rate_hz;
  config.exposure_reach_ns = MakeScenarioShutter(s).ReachNs(run.eye.pinhole.height_px);
  static_cast<BenchFaults&>(config) = s.faults.bench;
  config.seed = SeedOf(s, RandomStream::kEncoders);
  return config;
}

}  // namespace fovea::sim
