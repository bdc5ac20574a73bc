// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/config/vision_keys.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/host/robots/shipped_robots.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/fovea/atlas/bench.hpp"
#include "tools/fovea/atlas/files.hpp"

namespace fovea::atlas {
namespace {

// Each key's value. InputError: what the simulator said.
std::map<std::string, std::string> ValuesOf(const std::string& scenario,
                                            const std::vector<std::string>& assignments) {
  std::string command =
      bench::Quoted(bench::SimulatorBeside("fovea atlas")) + " keys --values " + bench::Quoted(scenario);
  for (const std::string& assignment : assignments) {
    command += " --set " + bench::Quoted(assignment);
  }
  const bench::ShellResult result = bench::RunShell(command + " 2>&1");
  if (!result.done) {
    throw config::InputError(ReasonOf(result.output));
  }
  return nlohmann::json::parse(result.output).get<std::map<std::string, std::string>>();
}

// The simulator has checked the values. Unlike a real camera's, its focal length and centre may be 0: they
// then follow from the angle of view.
void AddCameraKeys(config::CalibrationSettings& camera, double& hfov_deg, config::KeyTable& keys) {
  constexpr double kMost = 1e6;
  vision::Intrinsics& in = camera.intrinsics;
  keys.Integer("camera.width_px", in.width_px, 1, static_cast<int>(kMost), "px", "");
  keys.Integer("camera.height_px", in.height_px, 1, static_cast<int>(kMost), "px", "");
  keys.Number("camera.f_u_px", in.f_u_px, 0.0, kMost, "px", "");
  keys.Number("camera.f_v_px", in.f_v_px, 0.0, kMost, "px", "");
  keys.Number("camera.c_u_px", in.c_u_px, 0.0, kMost, "px", "");
  keys.Number("camera.c_v_px", in.c_v_px, 0.0, kMost, "px", "");
  keys.Number("camera.hfov_deg", hfov_deg, 0.0, 180.0, "deg", "");
  keys.Numbers("camera.mount_xyz", camera.mount_xyz, 3, 3, -kMost, kMost, "m", "");
  keys.Numbers("camera.mount_rpy_deg", camera.mount_rpy_deg, 3, 3, -kMost, kMost, "deg", "");
}

// As the simulator's ideal camera, when only its angle of view is known.
vision::Intrinsics CameraOf(vision::Intrinsics camera, double hfov_deg) {
  if (camera.f_u_px == 0.0) {
    const double half = 0.5 * hfov_deg * std::numbers::pi / 180.0;
    camera.f_u_px = 0.5 * camera.width_px / std::tan(half);
    camera.f_v_px = camera.f_u_px;
    camera.c_u_px = 0.5 * (camera.width_px - 1);
    camera.c_v_px = 0.5 * (camera.height_px - 1);
  }
  return camera;
}

}  // namespace

const char* ScenarioOf(const std::string& target) { return target == "sphere" ? "ball" : target.c_str(); }

std::vector<std::string> SceneAssignments(const std::vector<std::string>& callers) {
  std::vector<std::string> assignments{"safety.planes=[0,0,1,0.03]",
                                       fmt::format("safety.boxes=[{:.4f}]", fmt::join(BoxesOfThings(), ","))};
  assignments.insert(assignments.end(), callers.begin(), callers.end());
  return assignments;
}

Scene LoadScene(const std::string& target, const std::vector<std::string>& assignments) {
  config::ServoSettings servo;
  config::TargetSettings target_settings;
  config::CalibrationSettings camera;
  std::string arm;
  double hfov_deg = 0.0;
  config::KeyTable keys;
  config::AddServoKeys(servo, keys);
  config::AddTargetKeys(target_settings, keys);
  AddCameraKeys(camera, hfov_deg, keys);
  keys.Text("arm.model", arm, "");
  config::VisionSettings vision;
  config::AddVisionKeys(vision, keys);
  std::vector<double> boxes;
  keys.Numbers("bench.boxes", boxes, 0, 1000, -1e6, 1e6, "m", "");
  keys.ApplyRecorded(ValuesOf(ScenarioOf(target), assignments));
  Scene scene;
  scene.camera = CameraOf(camera.intrinsics, hfov_deg);
  scene.reach = {vision.config.distance_min, vision.config.distance_max};
  scene.boxes = config::MakeBoxes("bench.boxes", boxes);
  const robots::Robot robot = robots::LoadRobot(robots::FindRobot(arm, "arm.model"));
  scene.drawn = std::make_shared<const DrawnArm>(robot);
  scene.servo = config::MakeServoConfig(servo, {robot.name, robot.model, {}}, config::MakeMount(camera),
                                        scene.camera, target_settings);
  return scene;
}

Scene WithGoal(const Scene& scene, const Goal& goal) {
  Scene other = scene;
  other.servo.feature.p_CO_C_star = model::Vec3(goal.xyz[0], goal.xyz[1], goal.xyz[2]);
  other.servo.feature.R_CO_star = config::RollPitchYaw(goal.rpy_deg);
  return other;
}

}  // namespace fovea::atlas
