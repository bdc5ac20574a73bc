// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/robots/shipped_robots.hpp"
#include "firmware/targets/linux/cameras/camera_driver.hpp"

namespace fovea::hw {
namespace {

namespace fs = std::filesystem;
using config::InputError;

constexpr const char* kDriverKey = "robot.driver";

void AddDriverKey(HwConfig& config, config::KeyTable& keys) {
  std::vector<std::string> names;
  std::string meanings;
  for (const ArmDriverEntry& driver : ArmDrivers()) {
    names.emplace_back(driver.name);
    meanings += fmt::format("{}{}: {}", meanings.empty() ? "" : "; ", driver.name, driver.meaning);
  }
  keys.Choice(kDriverKey, config.robot.driver, names, meanings);
}

void AddCameraDriverKeys(HwConfig& config, config::KeyTable& keys) {
  std::vector<std::string> names{"none"};
  std::string meanings;
  std::string devices;
  for (const CameraDriverEntry& driver : CameraDrivers()) {
    names.emplace_back(driver.name);
    meanings += fmt::format("{}: {}; ", driver.name, driver.meaning);
    devices += fmt::format("{}{}: {}", devices.empty() ? "" : "; ", driver.name, driver.device);
  }
  keys.Choice("camera.driver", config.camera.driver, names,
              meanings + "none: the arm is held where it stands");
  keys.Text("camera.device", config.camera.device, devices);
}

fs::path Shipped() { return config::ShareFolder() / "hardware"; }

fs::path FindConfig(const std::string& name_or_path) {
  if (fs::path(name_or_path).extension() == ".toml") {
    return name_or_path;
  }
  fs::path shipped = Shipped() / (name_or_path + ".toml");
  if (fs::is_regular_file(shipped)) {
    return shipped;
  }
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(Shipped(), ignored)) {
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  throw InputError(fmt::format("unknown configuration \"{}\"{}; shipped are {} (or give the path of a .toml)",
                               name_or_path, config::DidYouMean(name_or_path, names),
                               fmt::join(names, ", ")));
}

// The known keys depend on the driver that `settings` name, so the driver is chosen first.
void ChooseDriver(const std::vector<config::Setting>& settings, HwConfig& config) {
  config::KeyTable keys;
  AddDriverKey(config, keys);
  for (const config::Setting& setting : settings) {
    if (setting.key == kDriverKey) {
      keys.Apply(setting);
    }
  }
}

}  // namespace

config::KeyTable HwKeys(HwConfig& c) {
  config::KeyTable keys;
  keys.Text("arm.model", c.arm.model, "a shipped arm by name, or the path of an arm file or URDF");
  config::AddLoadKeys(c.arm.load, keys);
  AddDriverKey(c, keys);
  ArmDriverOf(c).add_keys(c, keys);
  auto& camera = c.camera;
  AddCameraDriverKeys(c, keys);
  keys.Text("camera.pixel_format", camera.pixel_format,
            "Mono8, BayerRG8, BayerGR8, BayerGB8, BayerBG8, YUYV, RGB8 or BGR8; \"\": the camera's setting");
  keys.Number("camera.rate_hz", camera.rate_hz, 0.0, 1000.0, "Hz",
              "frames per second; 0: the camera's setting");
  keys.Number("camera.exposure_ms", camera.exposure_ms, 0.0, 1000.0, "ms",
              "exposure time; 0: the camera's setting");
  keys.Number("camera.gain", camera.gain, -1.0, 1000.0, "",
              "gain in the camera's own unit; negative: the camera's setting");
  keys.Integer("camera.packet_size", camera.packet_size, 0, 65000, "bytes",
               "packet size of GigE Vision; 0: the largest that the network carries");
  keys.Choice("camera.stamp_at", camera.stamp_at, {"start", "middle", "end"},
              "point of the exposure at which the camera takes its stamp");
  keys.Number("camera.transport_ms", camera.transport_ms, 0.0, 1000.0, "ms",
              "least time from a stamp to the arrival of its picture, used if the camera's clock cannot be "
              "read; an error in it is a latency that the prediction does not compensate");
  keys.Choice("camera.time", camera.time, {"computer", "device"},
              "clock of the stamps; device: the camera's clock, which must agree with the loop's (PTP, or a "
              "simulated camera in lockstep)");
  config::AddCalibrationKeys(camera.calibration, keys);
  config::AddVisionKeys(c.vision, keys);
  config::AddTargetKeys(c.target, keys);
  keys.Number(
      "robot.speed_scale", c.robot.speed_scale, 0.01, 1.0, "",
      "share of servo.lambda, servo.lambda_near, safety.joint_velocity_fraction, safety.cartesian_speed and "
      "safety.rotation_speed that is used");
  keys.Number(
      "input.dead_man_s", c.input.dead_man_s, 0.0, 3600.0, "s",
      "the arm is held after this time without a line on standard input, by the loop's clock, until somebody "
      "requests motion again; 0: no operator is needed");
  keys.Integer("loop.priority", c.loop.priority, 1, 98, "", "priority of the servo's thread, SCHED_FIFO");
  keys.Integer("loop.cpu", c.loop.cpu, -1, 1023, "", "processor of the servo's thread; -1: any");
  keys.Number("check.seconds", c.check.seconds, 0.1, 3600.0, "s",
              "how long --check measures a thread's wake-up, and the camera");
  keys.Number(
      "check.gravity_torque", c.check.gravity_torque, 0.1, 100.0, "Nm",
      "largest difference of a joint's torque at rest from the model's gravity; above it motion is refused");
  keys.Number("check.gravity_s", c.check.gravity_s, 0.01, 60.0, "s", "averaging time of that torque");
  keys.Number("log.picture_rate_hz", c.log.picture_rate_hz, 0.0, 1000.0, "Hz",
              "with --out: maximum rate of the pictures in the log");
  keys.Flag("log.film", c.log.film, "with --out: the camera's film, as camera.mp4 and in the report");
  config::AddServoKeys(c.servo, keys);
  return keys;
}

HwConfig LoadHwConfig(const std::string& name_or_path, const std::vector<std::string>& assignments) {
  const fs::path file = FindConfig(name_or_path);
  HwConfig config;
  config.name = file.stem().string();
  std::vector<config::Setting> settings = config::ReadTomlFile(file);
  for (const std::string& assignment : assignments) {
    settings.push_back(config::ParseAssignment(assignment));
  }
  ChooseDriver(settings, config);
  const config::KeyTable keys = HwKeys(config);
  for (const config::Setting& setting : settings) {
    keys.Apply(setting);
  }
  ArmDriverOf(config).check_settings(config);
  const config::LearntQuantities learnt = config::LearntOf(config.servo);
  if ((learnt.latency || learnt.payload) && !config.HasCamera()) {
    throw InputError("servo.learn is not allowed with camera.driver = \"none\": the servo needs to see");
  }
  return config;
}

robots::Robot LoadHwRobot(const HwConfig& config) {
  robots::Robot robot = robots::LoadRobot(robots::FindRobot(config.arm.model, "arm.model"));
  const int num_joints = ArmDriverOf(config).num_joints;
  if (robot.model.num_joints != num_joints) {
    throw InputError(fmt::format(
        "arm.model = \"{}\" is not allowed: it has {} joints, a robot of robot.driver = \"{}\" has {}",
        config.arm.model, robot.model.num_joints, config.robot.driver, num_joints));
  }
  if (const model::Load load = config::MakeLoad(config.arm.load); load.mass > 0.0) {
    model::Attach(load, robot.model);
  }
  return robot;
}

config::ServoConfig MakeHwServoConfig(const HwConfig& config, const robots::Robot& robot) {
  config::ServoSettings settings = config.servo;
  config::ScaleSpeed(config.robot.speed_scale, settings);
  const config::NamedArm arm{robot.name, robot.model, config::MakeLoad(config.arm.load)};
  if (!config.HasCamera()) {
    settings.keep_in_view = false;  // without a camera there is no view
    return config::MakeServoConfig(settings, arm, model::Pose{}, vision::Intrinsics{},
                                   config::TargetSettings{});
  }
  return config::MakeServoConfig(settings, arm, config::MakeMount(config.camera.calibration),
                                 config::MakeIntrinsics(config.camera.calibration), config.target);
}

RestMean MakeRestMean(const HwConfig& config) {
  constexpr double kStatesPerSecond = 1000.0;
  return {std::max(1, static_cast<int>(kStatesPerSecond * config.check.gravity_s)),
          config.servo.config.safety.boot_velocity};
}

}  // namespace fovea::hw
