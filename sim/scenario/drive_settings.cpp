// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/drive_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "firmware/core/model/types.hpp"
#include "firmware/host/config/input_error.hpp"
#include "sim/faults/chance.hpp"

namespace fovea::sim {
namespace {

// Softer, the arm would hang down by more than its controller can compensate [Nm/rad, N/m].
constexpr double kLeastStiffness = 100.0;

double EntryOf(const std::vector<double>& list, std::size_t joint) {
  return list.empty() ? 0.0 : list.size() == 1 ? list[0] : list[joint];
}

bool IsAny(const std::vector<double>& list) {
  return std::any_of(list.begin(), list.end(), [](double entry) { return entry > 0.0; });
}

}  // namespace

void AddDriveKeys(DriveSettings& d, config::KeyTable& keys) {
  const double most_ms = 1e3 * kMostDelayTicks * hal::kTickPeriodS;
  keys.Number("arm.torque_bandwidth_hz", d.torque_bandwidth_hz, 0.0, 1e5, "Hz",
              "corner frequency of a first-order lag of the joints' torques; 0: no lag");
  keys.Number("arm.torque_delay_ms", d.torque_delay_ms, 0.0, most_ms, "ms",
              "pure delay of the joints' torques");
  keys.OneOrMore("arm.torque_quantum", d.torque_quantum, model::kMaxJoints, 0.0, 1e3, "Nm",
                 "torques are rounded to multiples of it; no rounding when not given");
  keys.OneOrMore("arm.torque_ripple", d.torque_ripple, model::kMaxJoints, 0.0, 1e3, "Nm",
                 "amplitude of a torque that changes with the joint's angle as a sine; none when not given");
  keys.Number("arm.ripple_cycles", d.ripple_cycles, 0.0, 1e5, "",
              "periods of that sine per turn of the joint: the order of the ripple times the gear's ratio");
  keys.Number("arm.velocity_filter_hz", d.velocity_filter_hz, 0.0, 1e4, "Hz",
              "measured velocities are differences of measured positions, filtered with this corner "
              "frequency; 0: true velocities and arm.velocity_noise");
  keys.OneOrMore("arm.joint_stiffness", d.joint_stiffness, model::kMaxJoints, 0.0, 1e9, "Nm/rad",
                 "spring between each motor and its link, at least 100; 0: rigid; rigid when not given");
  keys.OneOrMore("arm.joint_damping", d.joint_damping, model::kMaxJoints, 0.0, 1e6, "Nm s/rad",
                 "damper beside each spring of arm.joint_stiffness; none when not given");
  keys.Choice("arm.encoder_side", d.encoder_side, {"motor", "link"},
              "where the encoders of elastic joints are: on the motor, or behind the spring");
}

void CheckDrives(const DriveSettings& d, int num_joints) {
  struct List {
    const char* key;
    std::size_t entries;
  };
  for (const List& list : {List{"arm.torque_quantum", d.torque_quantum.size()},
                           {"arm.torque_ripple", d.torque_ripple.size()},
                           {"arm.joint_stiffness", d.joint_stiffness.size()},
                           {"arm.joint_damping", d.joint_damping.size()}}) {
    if (list.entries > 1 && static_cast<int>(list.entries) != num_joints) {
      throw config::InputError(
          fmt::format("{} has {} entries: 1 or {} are allowed", list.key, list.entries, num_joints));
    }
  }
  for (const double stiffness : d.joint_stiffness) {
    if (IsAny(d.joint_stiffness) && stiffness < kLeastStiffness) {
      throw config::InputError(fmt::format(
          "arm.joint_stiffness = {} is not allowed: a joint has at least {} Nm/rad, or all have 0", stiffness,
          kLeastStiffness));
    }
  }
  if (IsAny(d.joint_damping) && !IsAny(d.joint_stiffness)) {
    throw config::InputError("arm.joint_damping is not allowed without arm.joint_stiffness");
  }
}

void CheckRotors(const DriveSettings& d, const SimRobot& robot) {
  for (const SimLink& link : robot.links) {
    if (IsAny(d.joint_stiffness) && link.dof >= 0 && !(link.rotor_inertia > 0.0)) {
      throw config::InputError(fmt::format(
          "arm.joint_stiffness is not allowed: joint {} has no rotor behind its spring (arm.rotor_inertia = "
          "{}; above 0 is allowed)",
          link.dof + 1, link.rotor_inertia));
    }
  }
}

std::vector<JointSpring> MakeJointSprings(const DriveSettings& d, int num_joints) {
  std::vector<JointSpring> springs;
  for (std::size_t i = 0; IsAny(d.joint_stiffness) && i < static_cast<std::size_t>(num_joints); ++i) {
    springs.push_back({EntryOf(d.joint_stiffness, i), EntryOf(d.joint_damping, i)});
  }
  return springs;
}

std::vector<TorqueDriveConfig> MakeDrives(const DriveSettings& d, int num_joints, std::uint64_t seed) {
  std::vector<TorqueDriveConfig> drives;
  if (d.torque_bandwidth_hz == 0.0 && d.torque_delay_ms == 0.0 && !IsAny(d.torque_quantum) &&
      !IsAny(d.torque_ripple)) {
    return drives;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_joints); ++i) {
    drives.push_back({.bandwidth_hz = d.torque_bandwidth_hz,
                      .delay_s = 1e-3 * d.torque_delay_ms,
                      .quantum = EntryOf(d.torque_quantum, i),
                      .ripple = EntryOf(d.torque_ripple, i),
                      .ripple_cycles = d.ripple_cycles,
                      .ripple_phase = 2.0 * std::numbers::pi * Chance(seed, i)});
  }
  return drives;
}

}  // namespace fovea::sim
