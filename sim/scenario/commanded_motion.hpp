// SPDX-License-Identifier: Apache-2.0
// The commanded motions of a scenario, as a source for the servo's loop.
#pragma once

#include <Eigen/Geometry>
#include <variant>

#include "firmware/core/moves/motion_command.hpp"

namespace fovea::sim {

// q(t) = from + velocity t + amplitude sin(omega t) for each joint, t from the run's start.
struct CommandedJoints {
  hal::JointArray from{};       // [num_joints] [rad, m]
  hal::JointArray velocity{};   // [num_joints]
  hal::JointArray amplitude{};  // [num_joints]
  double omega = 1.0;           // [rad/s]

  [[nodiscard]] moves::MotionCommand At(double t_s) const noexcept;
};

// q(t) = from + amplitude sin(multiple angle) for each joint. The angle's rate rises from 0 to omega within
// the first second.
struct CommandedWaves {
  hal::JointArray from{};       // [num_joints] [rad, m]
  hal::JointArray amplitude{};  // [num_joints]
  hal::JointArray multiple{};   // [num_joints]
  double omega = 1.0;           // [rad/s]

  [[nodiscard]] moves::MotionCommand At(double t_s) const noexcept;
};

// The end effector moves to the circle's lowest point until lead_s. Then it follows the circle, at full speed
// after one second.
struct CommandedCircle {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // p_B [m]
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();  // two unit vectors that span its plane, in B
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  Eigen::Quaterniond hand = Eigen::Quaterniond::Identity();  // R_BE, constant
  double radius = 0.15;                                      // [m]
  double rate_hz = 0.5;
  double lead_s = 3.0;

  [[nodiscard]] moves::MotionCommand At(double t_s) const noexcept;
};

// The joints move to the arm's ready posture.
struct CommandedHome {
  [[nodiscard]] moves::MotionCommand At(double t_s) const noexcept;
};

using CommandedMotion = std::variant<CommandedJoints, CommandedWaves, CommandedCircle, CommandedHome>;

class CommandedMotionSource final : public moves::MotionSource {
 public:
  explicit CommandedMotionSource(const CommandedMotion& motion) : motion_(motion) {}
  moves::MotionCommand At(std::int64_t now_ns) noexcept override;

 private:
  CommandedMotion motion_;
};

}  // namespace fovea::sim
