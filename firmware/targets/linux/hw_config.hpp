// SPDX-License-Identifier: Apache-2.0
// The configuration of fovea-hw.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/load_keys.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/config/vision_keys.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/robots/arm_drivers.hpp"

namespace fovea::hw {

struct HwConfig {
  std::string name;

  struct {
    std::string model = "panda";
    config::LoadSettings load;
  } arm;

  struct {
    std::string driver = "fci5";
    ArmDriverSettings of_driver;
    double speed_scale = 1.0;
  } robot;

  struct {
    double dead_man_s = 5.0;
  } input;

  struct {
    std::string driver = "none";
    std::string device;
    std::string pixel_format;
    double rate_hz = 0.0;
    double exposure_ms = 0.0;
    double gain = -1.0;
    int packet_size = 0;
    std::string stamp_at = "start";
    double transport_ms = 0.0;
    std::string time = "computer";
    config::CalibrationSettings calibration;
  } camera;

  struct {
    int priority = 80;
    int cpu = -1;
  } loop;

  struct {
    double seconds = 10.0;
    double gravity_torque = 2.0;  // [Nm]
    double gravity_s = 0.5;
  } check;

  struct {
    double picture_rate_hz = 30.0;
    bool film = true;
  } log;

  config::VisionSettings vision;
  config::TargetSettings target;
  config::ServoSettings servo;

  [[nodiscard]] bool HasCamera() const { return camera.driver != "none"; }
};

// The keys of all sections, bound to `config`, which must outlive the table. The robot's keys are those of
// config.robot.driver, which must be in the list.
config::KeyTable HwKeys(HwConfig& config);

// Reads a shipped configuration by name, or a .toml by path, then applies `assignments` ("key=value").
// InputError.
HwConfig LoadHwConfig(const std::string& name_or_path, const std::vector<std::string>& assignments);

// The arm of arm.model, with its load.
robots::Robot LoadHwRobot(const HwConfig& config);

// The servo's configuration: with a camera from its calibration, without one for an arm that is held.
// InputError.
config::ServoConfig MakeHwServoConfig(const HwConfig& config, const robots::Robot& robot);

// The mean for the comparison of gravity: its number of states and its speed limit.
RestMean MakeRestMean(const HwConfig& config);

}  // namespace fovea::hw
