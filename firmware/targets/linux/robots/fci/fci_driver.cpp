// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/robots/fci/fci_driver.hpp"

#include <fmt/format.h>

#include "firmware/host/config/input_error.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/robots/fci/fci_check.hpp"

namespace fovea::hw {
namespace {

const FciDriver::Settings& SettingsOf(const HwConfig& config) {
  return std::get<FciDriver::Settings>(config.robot.of_driver);
}

}  // namespace

void FciDriver::AddKeys(Settings& settings, config::KeyTable& keys) {
  keys.Text("robot.host", settings.host, "address of the robot's controller");
  keys.Integer("robot.port", settings.port, 1, 65535, "", "TCP port of the robot's controller");
  keys.Flag("robot.set_load", settings.set_load,
            "send arm.load_* to the robot; false: the robot's own settings contain the load");
  keys.Choice("robot.time", settings.time, {"computer", "robot"},
              "clock of the stamps; robot: that of a simulated robot in lockstep");
  keys.Number("robot.state_timeout_ms", settings.state_timeout_ms, 1.0, 10000.0, "ms",
              "maximum wait for a robot state; after it, the tick runs without a new state; at most "
              "safety.arm_lost_ticks with robot.time = \"computer\"; use a large value in lockstep");
  keys.Number("robot.torque_step", settings.torque_step, 0.001, 1.0, "Nm",
              "largest change of a joint's torque from one state to the next");
}

void FciDriver::CheckSettings(const HwConfig& config) {
  const Settings& settings = SettingsOf(config);
  const int most_ms = config.servo.config.safety.arm_lost_ticks;
  if (settings.time == "computer" && settings.state_timeout_ms > most_ms) {
    throw config::InputError(fmt::format(
        "robot.state_timeout_ms = {} is not allowed: at most safety.arm_lost_ticks, which is {} ms",
        settings.state_timeout_ms, most_ms));
  }
}

FciDriver::FciDriver(const HwConfig& config)
    : config_(config), settings_(SettingsOf(config)), by_robot_(settings_.time == "robot") {}

std::string FciDriver::address() const { return fmt::format("{}:{}", settings_.host, settings_.port); }

void FciDriver::Check(const HwConfig& config, const robots::Robot& robot, std::vector<CheckRow>& rows) {
  CheckFciRobot(config, robot, rows);
}

hal::Arm& FciDriver::Connect(bool allow_motion) {
  return arm_.emplace(FrankaConfigOf(config_, allow_motion), by_robot_ ? &robot_time_ : nullptr);
}

// The robot counts over its last states. While a motion ends, it sends some states that need no command.
void FciDriver::Stop() noexcept {
  success_rate_ = arm_->robot_state().control_command_success_rate;
  arm_->Stop();
}

const char* FciDriver::failure() const noexcept {
  return arm_ && arm_->phase() == franka::MotionPhase::kFailed ? arm_->failure() : nullptr;
}

RobotFigures FciDriver::figures() const {
  const franka::FrankaCounters& c = arm_->counters();
  return {c.states,
          c.lost_states,
          c.commands,
          {{"late_states", c.late_states},
           {"duplicate_states", c.duplicate_states},
           {"skipped_states", c.skipped_states},
           {"malformed", c.malformed},
           {"foreign", c.foreign},
           {"repeated_commands", c.repeated_commands},
           {"rate_limited", c.rate_limited},
           {"timeouts", c.timeouts},
           {"motions", c.motions}},
          success_rate_.value_or(arm_->robot_state().control_command_success_rate)};
}

franka::FrankaConfig FrankaConfigOf(const HwConfig& config, bool allow_motion) {
  const FciDriver::Settings& settings = SettingsOf(config);
  franka::FrankaConfig out;
  out.host = settings.host;
  out.port = static_cast<std::uint16_t>(settings.port);
  out.allow_motion = allow_motion;
  out.state_timeout_ns = static_cast<std::int64_t>(settings.state_timeout_ms * 1e6);
  out.torque_step_max.fill(settings.torque_step);
  if (settings.set_load) {
    const model::Load load = config::MakeLoad(config.arm.load);
    out.load.mass = load.mass;
    Eigen::Map<model::Vec3>(out.load.F_x_Cload.data()) = load.p_ECom;
    Eigen::Map<model::Mat3>(out.load.I_load.data()) = load.I_Com_E;
  }
  return out;
}

}  // namespace fovea::hw
