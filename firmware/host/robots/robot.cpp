// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/robots/robot.hpp"

#include <fmt/format.h>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/inside_folder.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/robots/urdf_chain.hpp"

namespace fovea::robots {
namespace {

// Limits of a joint whose file gives none: full speed in 0.25 s, full acceleration in 5 ms, full torque in
// 0.1 s. Gentle values for an arm of a person's size.
struct Derived {
  double velocity_to_acceleration = 1.0 / 0.25;
  double acceleration_to_jerk = 1.0 / 0.005;
  double torque_to_torque_rate = 1.0 / 0.1;
};
constexpr Derived kDerived;

// Limits and figures that URDF cannot express, one entry per joint, or none.
struct ExtraLimits {
  std::vector<double> acceleration;
  std::vector<double> jerk;
  std::vector<double> torque_rate;
  std::vector<double> ready;
  std::vector<double> rotor_inertia;
};

// Entry `i` of `values`, or `derived` if `values` is empty.
double EntryOr(const std::vector<double>& values, std::size_t i, double derived) {
  return values.empty() ? derived : values[i];
}

void CheckSize(const std::filesystem::path& file, const std::string& key, const std::vector<double>& values,
               int num_joints) {
  if (!values.empty() && static_cast<int>(values.size()) != num_joints) {
    throw config::InputError(fmt::format("{}: {} has {} entries, the arm has {} joints", file.string(), key,
                                         values.size(), num_joints));
  }
}

void SetLimits(const std::filesystem::path& file, const ExtraLimits& extra, model::ArmModel& arm) {
  CheckSize(file, "acceleration_max", extra.acceleration, arm.num_joints);
  CheckSize(file, "jerk_max", extra.jerk, arm.num_joints);
  CheckSize(file, "torque_rate_max", extra.torque_rate, arm.num_joints);
  CheckSize(file, "ready", extra.ready, arm.num_joints);
  CheckSize(file, "rotor_inertia", extra.rotor_inertia, arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    model::Joint& joint = arm.joints[k];
    joint.ddq_max = EntryOr(extra.acceleration, k, joint.dq_max * kDerived.velocity_to_acceleration);
    joint.dddq_max = EntryOr(extra.jerk, k, joint.ddq_max * kDerived.acceleration_to_jerk);
    joint.dtau_max = EntryOr(extra.torque_rate, k, joint.tau_max * kDerived.torque_to_torque_rate);
    joint.rotor_inertia = EntryOr(extra.rotor_inertia, k, 0.0);
    const double middle = 0.5 * (joint.q_min + joint.q_max);
    arm.q_ready[k] = EntryOr(extra.ready, k, middle);
    if (arm.q_ready[k] < joint.q_min || arm.q_ready[k] > joint.q_max) {
      throw config::InputError(fmt::format("{}: ready[{}] = {} is outside the joint's range {} to {}",
                                           file.string(), i, arm.q_ready[k], joint.q_min, joint.q_max));
    }
  }
}

void CheckIsInside(const std::filesystem::path& root, const std::filesystem::path& file,
                   const std::string& who) {
  if (!root.empty() && !config::IsInside(root, std::filesystem::absolute(file))) {
    throw config::InputError(
        fmt::format("{} is not allowed: it lies outside {}, the folder of the file that names it", who,
                    std::filesystem::absolute(root).lexically_normal().string()));
  }
}

}  // namespace

Robot LoadRobot(const std::filesystem::path& file, const std::filesystem::path& root) {
  Robot robot;
  robot.name = file.stem().string();
  robot.root = root;
  CheckIsInside(root, file, file.string());
  if (file.extension() == ".urdf") {
    robot.urdf = file;
    ReadUrdfChain(robot);
    SetLimits(file, ExtraLimits{}, robot.model);
    return robot;
  }
  std::string urdf;
  ExtraLimits extra;
  config::KeyTable keys;
  constexpr double kHuge = 1e6;
  constexpr std::size_t kMax = model::kMaxJoints;
  keys.Text("urdf", urdf, "the robot's URDF, relative to this file's folder");
  keys.Text("base", robot.base_link, "link whose frame is B; the root when not given");
  keys.Text("tip", robot.tip_link, "link whose frame is E; the only leaf when not given");
  keys.Numbers("acceleration_max", extra.acceleration, 1, kMax, 1e-3, kHuge, "rad/s^2", "per joint");
  keys.Numbers("jerk_max", extra.jerk, 1, kMax, 1e-3, kHuge, "rad/s^3", "per joint");
  keys.Numbers("torque_rate_max", extra.torque_rate, 1, kMax, 1e-3, kHuge, "Nm/s", "per joint");
  keys.Numbers("ready", extra.ready, 1, kMax, -kHuge, kHuge, "rad", "a posture far from limits, per joint");
  keys.Numbers("rotor_inertia", extra.rotor_inertia, 1, kMax, 0.0, kHuge, "kg m^2",
               "inertia of the motor's rotor times the gear's ratio squared, per joint; 0 when not given");
  for (const config::Setting& setting : config::ReadTomlFile(file)) {
    keys.Apply(setting);
  }
  if (urdf.empty()) {
    throw config::InputError(file.string() + ": urdf is missing");
  }
  robot.urdf = file.parent_path() / urdf;
  CheckIsInside(root, robot.urdf, fmt::format("{}: urdf = \"{}\"", file.string(), urdf));
  ReadUrdfChain(robot);
  SetLimits(file, extra, robot.model);
  return robot;
}

}  // namespace fovea::robots
