// What the interface's setters set, and what they refuse.
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
  franka::FramePose F_T_NE;  // not to be set by the interface: no hand is mounted
  franka::FramePose NE_T_EE;
  franka::Load load;
  franka::Filters filters;
};

// Whether `pose` is a rigid one: a rotation, and (0, 0, 0, 1) below.
[[nodiscard]] bool IsPose(const franka::Matrix4& pose);

// Applies the setter `command` with its `payload` to `settings`; kInvalidArgument leaves them as they were.
[[nodiscard]] franka::SetterStatus ApplySetter(franka::Command command, std::span<const std::byte> payload,
                                               FciSettings& settings);

}  // namespace fovea::sim
