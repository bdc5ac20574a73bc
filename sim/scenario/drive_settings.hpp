// SPDX-License-Identifier: Apache-2.0
// [arm]: drives and sensors that are not ideal, one by one or as a preset. The servo believes nothing of
// them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host/config/key_table.hpp"
#include "sim/drives/elastic_joints.hpp"
#include "sim/drives/torque_drive.hpp"
#include "sim/robot/sim_robot.hpp"

namespace fovea::sim {

// A list has one entry for all joints, or one per joint.
struct DriveSettings {
  double torque_bandwidth_hz = 0.0;
  double torque_delay_ms = 0.0;
  std::vector<double> torque_quantum;  // empty: 0
  std::vector<double> torque_ripple;   // empty: 0
  double ripple_cycles = 200.0;
  double velocity_filter_hz = 0.0;
  std::vector<double> joint_stiffness{};  // empty or 0: rigid
  std::vector<double> joint_damping{};    // empty: 0
  std::string encoder_side = "motor";
};

// `settings` must outlive the table.
void AddDriveKeys(DriveSettings& settings, config::KeyTable& keys);

// InputError: a list has neither one entry nor `num_joints`, or a stiffness is not allowed.
void CheckDrives(const DriveSettings& settings, int num_joints);

// InputError: a joint of `robot` with a spring has no rotor.
void CheckRotors(const DriveSettings& settings, const SimRobot& robot);

// One for each of `num_joints`; empty if the joints are rigid.
std::vector<JointSpring> MakeJointSprings(const DriveSettings& settings, int num_joints);

// One for each of `num_joints`, with phases of the ripple by `seed`; empty if torques act at once and
// exactly.
std::vector<TorqueDriveConfig> MakeDrives(const DriveSettings& settings, int num_joints, std::uint64_t seed);

}  // namespace fovea::sim
