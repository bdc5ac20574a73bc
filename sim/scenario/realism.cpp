// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/realism.hpp"

#include <fmt/format.h>

#include <vector>

#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {
namespace {

// Step of an encoder with 14 bits on the motor's side of a gear with the ratio 100 or 101 [rad].
constexpr double kStepBehind100 = 3.83e-6;
constexpr double kStepBehind101 = 3.8e-6;

struct Preset {
  const char* name;
  bool (*is_for)(const std::string& arm);
  const char* arms;                   // for people
  std::vector<double> rotor_inertia;  // [kg m^2]
  double encoder_noise;               // [rad]
  double encoder_quantum;             // [rad]
  DriveSettings drives;
};

const std::vector<Preset>& Presets() {
  static const std::vector<Preset> presets{
      {"panda",
       [](const std::string& arm) { return arm.starts_with("panda"); },
       "a Panda (a name that begins with \"panda\")",
       {0.605721456, 0.605721456, 0.462474144, 0.462474144, 0.205544064, 0.205544064, 0.205544064},
       1e-6,
       kStepBehind100,
       {.torque_bandwidth_hz = 100.0,
        .torque_delay_ms = 1.0,
        .torque_quantum = {0.042, 0.042, 0.042, 0.042, 0.006, 0.006, 0.006},
        .torque_ripple = {0.2, 0.2, 0.2, 0.2, 0.05, 0.05, 0.05},
        .ripple_cycles = 200.0,
        .velocity_filter_hz = 100.0}},
      {"ur",
       [](const std::string& arm) {
         return arm.size() > 2 && arm.starts_with("ur") && arm[2] >= '0' && arm[2] <= '9';
       },
       "a Universal Robot (a name that begins with \"ur\" and a digit)",
       {0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
       1e-6,
       kStepBehind101,
       {.torque_bandwidth_hz = 100.0,
        .torque_delay_ms = 2.0,
        .torque_quantum = {0.073, 0.073, 0.073, 0.014, 0.014, 0.014},
        .torque_ripple = {0.5, 0.5, 0.5, 0.1, 0.1, 0.1},
        .ripple_cycles = 202.0,
        .velocity_filter_hz = 100.0}},
  };
  return presets;
}

}  // namespace

void ApplyRealism(const std::set<std::string>& given, Scenario& s) {
  for (const Preset& preset : Presets()) {
    if (s.arm.realism != preset.name) {
      continue;
    }
    const auto set = [&given](const char* key, auto& field, const auto& value) {
      if (!given.contains(key)) {
        field = value;
      }
    };
    set("arm.rotor_inertia", s.arm.rotor_inertia, preset.rotor_inertia);
    set("arm.encoder_noise", s.arm.encoder_noise, preset.encoder_noise);
    set("arm.encoder_quantum", s.arm.encoder_quantum, preset.encoder_quantum);
    DriveSettings& drives = s.arm.drives;
    set("arm.torque_bandwidth_hz", drives.torque_bandwidth_hz, preset.drives.torque_bandwidth_hz);
    set("arm.torque_delay_ms", drives.torque_delay_ms, preset.drives.torque_delay_ms);
    set("arm.torque_quantum", drives.torque_quantum, preset.drives.torque_quantum);
    set("arm.torque_ripple", drives.torque_ripple, preset.drives.torque_ripple);
    set("arm.ripple_cycles", drives.ripple_cycles, preset.drives.ripple_cycles);
    set("arm.velocity_filter_hz", drives.velocity_filter_hz, preset.drives.velocity_filter_hz);
  }
}

void CheckRealism(const Scenario& s, const robots::Robot& robot) {
  for (const Preset& preset : Presets()) {
    if (s.arm.realism != preset.name) {
      continue;
    }
    if (!preset.is_for(robot.name)) {
      throw config::InputError(
          fmt::format("arm.realism = \"{}\" is not allowed with arm \"{}\": it is for {}", preset.name,
                      robot.name, preset.arms));
    }
    const auto joints = static_cast<int>(preset.rotor_inertia.size());
    if (robot.model.num_joints != joints) {
      throw config::InputError(fmt::format(
          "arm.realism = \"{}\" is not allowed with arm \"{}\": it is for {} joints, that arm has {}",
          preset.name, robot.name, joints, robot.model.num_joints));
    }
  }
}

}  // namespace fovea::sim
