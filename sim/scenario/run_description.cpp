// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/run_description.hpp"

#include <fmt/format.h>

#include "firmware/host/config/input_error.hpp"

#include "sim/scenario/compose.hpp"
#include "sim/scenario/scenario_arm.hpp"
#include "sim/scenario/solids.hpp"
#include "sim/scenario/true_bench.hpp"

namespace fovea::sim {

namespace {

// InputError: there is no analytic response to compare with.
TheoryConfig MakeTheoryConfig(const Scenario& s, const RunDescription& run) {
  const model::ArmModel& arm = run.servo.arm;
  if (arm.num_joints != 1 || arm.joints[0].type != model::JointType::kPrismatic) {
    throw config::InputError(fmt::format(
        "theory.enabled = true is not allowed with arm \"{}\": it needs an arm with one prismatic joint",
        run.robot.name));
  }
  constexpr double kLongest = 600.0;
  if (s.run.duration_s > kLongest) {
    throw config::InputError(fmt::format(
        "run.duration_s = {} is not allowed: with theory.enabled at most {} s", s.run.duration_s, kLongest));
  }
  TheoryConfig theory;
  theory.plant = {arm.links[0].mass, arm.joints[0].viscous, arm.joints[0].spring};
  theory.coulomb = arm.joints[0].coulomb;
  theory.law = run.servo.motion_law;
  if (run.motion) {
    if (!std::holds_alternative<CommandedJoints>(*run.motion)) {
      throw config::InputError(
          "theory.enabled = true is allowed only with motion.kind = \"joints\" or \"none\"");
    }
    theory.motion = std::get<CommandedJoints>(*run.motion);
  }
  const JointPush& push = s.faults.bench.push;
  theory.push = push.tau.size() > 0 ? push.tau[0] : 0.0;
  theory.push_s = push.window.start_s;
  theory.fit_begin_s = s.theory.fit_s[0];
  theory.fit_end_s = s.theory.fit_s[1];
  return theory;
}

// InputError: the run cannot end early as it asks.
void CheckEnd(const Scenario& s) {
  if (s.run.settled_s > 0.0 && (KeepsMoving(s.target) || s.motion.kind != "none")) {
    throw config::InputError(fmt::format(
        "run.settled_s = {} is not allowed: it needs a target that stands still, and motion.kind = \"none\"",
        s.run.settled_s));
  }
}

}  // namespace

RunDescription DescribeRun(const Scenario& scenario) {
  RunDescription run;
  run.scenario = scenario;
  const ScenarioArm arm = LoadScenarioArm(scenario);
  run.robot = arm.robot;
  CheckStart(scenario, run.robot);
  const Eigen::Isometry3d X_EC = CameraMount(scenario);
  run.pinhole = MakeScenarioPinhole(scenario);
  run.intrinsics = {run.pinhole.width_px, run.pinhole.height_px, run.pinhole.f_px,
                    run.pinhole.FocalV(), run.pinhole.c_u_px,    run.pinhole.c_v_px};
  run.lens = MakeScenarioLens(scenario);
  run.intrinsics.lens = {run.lens.k1, run.lens.k2, run.lens.p1, run.lens.p2, run.lens.k3};
  run.intrinsics.row_time = 1e-6 * scenario.camera.calibration.row_time_us;
  run.reach = {scenario.vision.config.distance_min, scenario.vision.config.distance_max};
  CheckLens(scenario);
  run.servo = config::MakeServoConfig(
      scenario.servo, {run.robot.name, run.robot.model, config::MakeLoad(scenario.arm.load)},
      model::Pose{X_EC.linear(), X_EC.translation()}, run.intrinsics, scenario.target);
  if (!scenario.servo.learn.empty() && !scenario.camera.enabled) {
    throw config::InputError(
        "servo.learn is not allowed with camera.enabled = false: the servo needs to see");
  }
  CheckSolids(scenario, run.servo);
  CheckGoal(scenario);
  CheckTimes(scenario);
  CheckEnd(scenario);
  CheckFaults(scenario.faults, run.robot.model.num_joints);
  const SimRobot robot = DrawTruth(arm.unloaded, run);
  CheckRotors(scenario.arm.drives, robot);
  run.scene = MakeRenderScene(run.bench, robot);
  run.scene.X_EC = run.eye.X_EC;
  if (scenario.motion.kind != "none") {
    run.motion = MakeMotion(scenario);
  }
  if (scenario.theory.enabled) {
    run.theory = MakeTheoryConfig(scenario, run);
  }
  return run;
}

}  // namespace fovea::sim
