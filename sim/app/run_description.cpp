#include "sim/app/run_description.hpp"

#include "sim/app/compose.hpp"

namespace fovea::sim {

RunDescription DescribeRun(const Scenario& scenario) {
  RunDescription run;
  run.scenario = scenario;
  run.robot = LoadScenarioRobot(scenario);
  const SimRobot robot = LoadSimRobot(run.robot.urdf, run.robot.base_link, run.robot.tip_link);
  CheckStart(scenario, run.robot);
  const Eigen::Isometry3d X_EC = CameraMount(scenario);
  run.servo =
      config::MakeServoConfig(scenario.servo, run.robot, model::Pose{X_EC.linear(), X_EC.translation()},
                              0.5 * scenario.target.diameter);
  CheckGoal(scenario);
  CheckTimes(scenario);
  run.scene = MakeRenderScene(scenario, robot);
  run.pinhole = MakeScenarioPinhole(scenario);
  run.intrinsics = {run.pinhole.width_px, run.pinhole.height_px, run.pinhole.f_px,
                    run.pinhole.f_px,     run.pinhole.c_u_px,    run.pinhole.c_v_px};
  return run;
}

}  // namespace fovea::sim
