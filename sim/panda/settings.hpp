// SPDX-License-Identifier: Apache-2.0
// The settings of the interface's setters, and their checks.
#pragma once

#include <span>

#include "fovea/franka/messages.hpp"

namespace fovea::sim {

struct FciSettings {
  franka::CollisionBehavior collision;
  franka::JointImpedance joint_impedance;
  franka::CartesianImpedance cartesian_impedance;
  franka::GuidingMode guiding;
  franka::FramePose EE_T_K;
  franka::FramePose F_T_NE;  // no setter changes it: no Franka hand is mounted
  franka::FramePose NE_T_EE;
  franka::Load load;
  franka::Filters filters;
};

// Whether `pose` is a rigid transform: a rotation matrix, and (0, 0, 0, 1) as the last row.
[[nodiscard]] bool IsPose(const franka::Matrix4& pose);

// Applies the setter `command` with its `payload` to `settings`. kInvalidArgument leaves them unchanged.
[[nodiscard]] franka::SetterStatus ApplySetter(franka::Command command, std::span<const std::byte> payload,
                                               FciSettings& settings);

}  // namespace fovea::sim
