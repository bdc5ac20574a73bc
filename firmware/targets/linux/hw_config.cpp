#include "firmware/targets/linux/hw_config.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/share_folder.hpp"

namespace fovea::hw {
namespace {

namespace fs = std::filesystem;
using config::InputError;

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
  throw InputError(fmt::format("unknown configuration \"{}\"; shipped are {} (or give the path of a .toml)",
                               name_or_path, fmt::join(names, ", ")));
}

// A read of the robot's state ends before the robot counts as lost.
void CheckTimes(const HwConfig& config) {
  const int most_ms = config.servo.config.safety.arm_lost_ticks;
  if (config.robot.time == "computer" && config.robot.state_timeout_ms > most_ms) {
    throw InputError(fmt::format(
        "robot.state_timeout_ms = {} is not allowed: at most safety.arm_lost_ticks, which is {} ms",
        config.robot.state_timeout_ms, most_ms));
  }
}

}  // namespace

config::KeyTable HwKeys(HwConfig& c) {
  config::KeyTable keys;
  keys.Text("arm.model", c.arm.model, "a shipped arm by name, or the path of an arm file or URDF");
  config::AddLoadKeys(c.arm.load, keys);
  keys.Text("robot.host", c.robot.host, "address of the robot's controller");
  keys.Integer("robot.port", c.robot.port, 1, 65535, "", "its TCP port");
  keys.Flag("robot.set_load", c.robot.set_load,
            "tell the robot of arm.load_*; false: its own settings know of it already");
  keys.Choice("robot.time", c.robot.time, {"computer", "robot"},
              "whose clock stamps are in; robot: of a simulated one in lockstep");
  keys.Number("robot.state_timeout_ms", c.robot.state_timeout_ms, 1.0, 10000.0, "ms",
              "no state for so long is a tick without one; at most safety.arm_lost_ticks with robot.time = "
              "\"computer\", long for a robot in lockstep");
  keys.Number("robot.torque_step", c.robot.torque_step, 0.001, 1.0, "Nm",
              "a joint's torque changes by no more from one state to the next");
  auto& camera = c.camera;
  keys.Choice(
      "camera.driver", camera.driver, {"none", "genicam", "v4l2", "recorded"},
      "genicam: GigE Vision or USB3 Vision; v4l2: Video4Linux2; recorded: a folder of pictures, or a video; "
      "none: the arm is "
      "held where it stands");
  keys.Text("camera.device", camera.device,
            "genicam: serial number, name or address, \"\" for the first one found; v4l2: the device's path, "
            "\"\" for "
            "/dev/video0; recorded: the path");
  keys.Text("camera.pixel_format", camera.pixel_format,
            "Mono8, BayerRG8, BayerGR8, BayerGB8, BayerBG8, YUYV, RGB8 or BGR8; \"\": as the camera is set");
  keys.Number("camera.rate_hz", camera.rate_hz, 0.0, 1000.0, "Hz",
              "frames per second; 0: as the camera is set");
  keys.Number("camera.exposure_ms", camera.exposure_ms, 0.0, 1000.0, "ms",
              "exposure time; 0: as the camera is set");
  keys.Number("camera.gain", camera.gain, -1.0, 1000.0, "",
              "in the camera's own unit; negative: as the camera is set");
  keys.Integer("camera.packet_size", camera.packet_size, 0, 65000, "bytes",
               "GigE Vision's; 0: the largest that the network carries");
  keys.Choice("camera.stamp_at", camera.stamp_at, {"start", "middle", "end"},
              "when in an exposure the camera takes its stamp");
  keys.Number("camera.transport_ms", camera.transport_ms, 0.0, 1000.0, "ms",
              "the least time from a stamp until its picture is here, where the camera's own clock cannot be "
              "asked; what "
              "is not known of it is latency that nothing makes up for");
  keys.Choice("camera.time", camera.time, {"computer", "device"},
              "whose clock stamps are in; device: one that is the loop's already (PTP, or a simulated camera "
              "in lockstep)");
  config::AddCalibrationKeys(camera.calibration, keys);
  config::AddVisionKeys(c.vision, keys);
  config::AddTargetKeys(c.target, keys);
  keys.Number("robot.speed_scale", c.robot.speed_scale, 0.01, 1.0, "",
              "share of servo.lambda, servo.lambda_near, safety.joint_velocity_fraction and "
              "safety.cartesian_speed that is used");
  keys.Number(
      "input.dead_man_s", c.input.dead_man_s, 0.0, 3600.0, "s",
      "no line on standard input for so long, by the loop's clock: the arm is held until somebody asks "
      "for motion anew; 0: nobody need be there");
  keys.Integer("loop.priority", c.loop.priority, 1, 98, "", "of the servo's thread, SCHED_FIFO");
  keys.Integer("loop.cpu", c.loop.cpu, -1, 1023, "", "the processor that it stays on; -1: any");
  keys.Number("check.seconds", c.check.seconds, 0.1, 3600.0, "s",
              "for so long --check measures how late a thread wakes up");
  keys.Number(
      "check.gravity_torque", c.check.gravity_torque, 0.1, 100.0, "Nm",
      "a joint's torque at rest may be so far off the model's gravity; further, and motion is refused");
  keys.Number("check.gravity_s", c.check.gravity_s, 0.01, 60.0, "s", "over so long at rest it is averaged");
  keys.Number("log.picture_rate_hz", c.log.picture_rate_hz, 0.0, 1000.0, "Hz",
              "with --out: at most so many pictures per second are kept in the log");
  keys.Flag("log.film", c.log.film, "with --out: what the eye saw, as camera.mp4 and in the report");
  config::AddServoKeys(c.servo, keys);
  return keys;
}

HwConfig LoadHwConfig(const std::string& name_or_path, const std::vector<std::string>& assignments) {
  const fs::path file = FindConfig(name_or_path);
  HwConfig config;
  config.name = file.stem().string();
  const config::KeyTable keys = HwKeys(config);
  for (const config::Setting& setting : config::ReadTomlFile(file)) {
    keys.Apply(setting);
  }
  for (const std::string& assignment : assignments) {
    keys.Apply(config::ParseAssignment(assignment));
  }
  CheckTimes(config);
  return config;
}

robots::Robot LoadHwRobot(const HwConfig& config) {
  const fs::path given = config.arm.model;
  const bool is_path = given.extension() == ".toml" || given.extension() == ".urdf";
  robots::Robot robot =
      robots::LoadRobot(is_path ? given : config::ShareFolder() / "robots" / (config.arm.model + ".toml"));
  if (robot.model.num_joints != franka::kJoints) {
    throw InputError(
        fmt::format("arm.model = \"{}\" is not allowed: it has {} joints, the robot at robot.host has {}",
                    config.arm.model, robot.model.num_joints, franka::kJoints));
  }
  if (const model::Load load = config::MakeLoad(config.arm.load); load.mass > 0.0) {
    model::Attach(load, robot.model);
  }
  return robot;
}

config::ServoConfig MakeHwServoConfig(const HwConfig& config, const robots::Robot& robot) {
  config::ServoSettings settings = config.servo;
  config::ScaleSpeed(config.robot.speed_scale, settings);
  if (!config.HasCamera()) {
    settings.keep_in_view = false;  // there is no picture to keep anything in
    return config::MakeServoConfig(settings, robot, model::Pose{}, vision::Intrinsics{},
                                   config::TargetSettings{});
  }
  return config::MakeServoConfig(settings, robot, config::MakeMount(config.camera.calibration),
                                 config::MakeIntrinsics(config.camera.calibration), config.target);
}

RestMean MakeRestMean(const HwConfig& config) {
  constexpr double kStatesPerSecond = 1000.0;
  return {std::max(1, static_cast<int>(kStatesPerSecond * config.check.gravity_s)),
          config.servo.config.safety.boot_velocity};
}

franka::FrankaConfig MakeFrankaConfig(const HwConfig& config, bool allow_motion) {
  franka::FrankaConfig out;
  out.host = config.robot.host;
  out.port = static_cast<std::uint16_t>(config.robot.port);
  out.allow_motion = allow_motion;
  out.state_timeout_ns = static_cast<std::int64_t>(config.robot.state_timeout_ms * 1e6);
  out.torque_step_max.fill(config.robot.torque_step);
  if (config.robot.set_load) {
    const model::Load load = config::MakeLoad(config.arm.load);
    out.load.mass = load.mass;
    Eigen::Map<model::Vec3>(out.load.F_x_Cload.data()) = load.p_ECom;
    Eigen::Map<model::Mat3>(out.load.I_load.data()) = load.I_Com_E;
  }
  return out;
}

}  // namespace fovea::hw
