// SPDX-License-Identifier: Apache-2.0
// Loads a robot's files into the plain ArmModel that the servo computes with. Outside the tick.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::robots {

struct Robot {
  std::string name;
  std::filesystem::path root;            // folder that must contain its files; empty: any folder
  std::filesystem::path urdf;            // simulators and viewers read shapes and friction from it
  std::string base_link;                 // frame B
  std::string tip_link;                  // frame E
  std::vector<std::string> joint_names;  // [num_joints] base to tip
  model::ArmModel model;
};

// Reads an arm file (.toml: the URDF's name, base and tip links, and limits and rotors, which URDF cannot
// express), or a bare .urdf, whose base is its root, whose tip is its only leaf, and whose acceleration, jerk
// and torque-rate limits are derived from velocity and effort (see kDerived in robot.cpp). `root` is for an
// arm named in an untrusted file: reads only files that lie in it after links are resolved.
//
// InputError, naming file, link or joint: file missing, malformed or outside `root`, unknown key, a chain
// that the servo cannot drive (a loop, a second moving branch, no moving joint, more than kMaxJoints, a joint
// type other than revolute, continuous, prismatic or fixed, a mimic joint), a moved link without inertia or
// with an impossible one, a missing or empty limit.
Robot LoadRobot(const std::filesystem::path& file, const std::filesystem::path& root = {});

}  // namespace fovea::robots
