// The simulated Panda as its network interface shows it: modes, motions, errors, and the controllers inside.
//
// No socket here: requests and commands come as plain data, a millisecond at a time. What the robot feels
// from outside is taken from the physics: what its motion needs beyond its own command.
#pragma once

#include <array>
#include <optional>

#include "fovea/franka/errors.hpp"
#include "fovea/franka/messages.hpp"
#include "sim/wire/fci_controller.hpp"
#include "sim/wire/fci_reference.hpp"
#include "sim/wire/fci_settings.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class FciRobot {
 public:
  // `robot` is the arm in `world`, of seven joints, with what it carries as links of its own; both outlive
  // this.
  FciRobot(World& world, const SimRobot& robot);

  [[nodiscard]] franka::SetterStatus Set(franka::Command command, std::span<const std::byte> payload);
  // kMotionStarted, or why not.
  [[nodiscard]] franka::MoveStatus Move(const franka::MoveRequest& request);
  [[nodiscard]] franka::StopStatus StopMove();
  [[nodiscard]] franka::RecoveryStatus Recover();
  // The client is gone: a motion ends, the robot holds.
  void Abandon();
  // The stop button: pressed, all stops; released, the robot is idle and without error, and joints that were
  // outside their limits have been put back by hand.
  void UserStop(bool pressed);

  // One millisecond, under `command` or, in a motion, without one.
  void Step(const std::optional<franka::RobotCommand>& command);

  [[nodiscard]] const franka::RobotState& state() const { return state_; }
  [[nodiscard]] bool moving() const { return state_.robot_mode == franka::RobotMode::kMove; }
  // Whether a command of the present motion has come.
  [[nodiscard]] bool commanded() const { return commanded_; }
  // How the last motion ended, once.
  [[nodiscard]] std::optional<franka::MoveStatus> TakeMoveEnd();

 private:
  void ShowMounted(const SimRobot& robot);
  void ApplyCommand(const std::optional<franka::RobotCommand>& command);
  void ApplyTorque(const franka::RobotCommand& command);
  void End(franka::MoveStatus status, franka::RobotMode mode);
  void Reflex(franka::Error error);
  [[nodiscard]] bool IsOutside() const;
  void CheckMeasured();
  void CheckDeviation(const franka::Vector3& most, franka::Error error);
  void CheckForces();
  void CountCommand(bool came);
  [[nodiscard]] Joints ControllerTorque() const;
  [[nodiscard]] Joints LoadTorque() const;
  void Measure(const Joints& q_before, const Joints& dq_before);
  void FeelForces(const Joints& q_before, const Joints& dq_before);
  void Show();

  World& world_;
  Chain chain_;
  FciSettings settings_;
  FciReference reference_;
  franka::MoveRequest move_;
  franka::RobotState state_;
  std::optional<franka::MoveStatus> move_end_;
  bool commanded_ = false;
  int missing_ = 0;               // commands in a row
  int waited_ = 0;                // states of this motion before its first command
  std::array<bool, 100> came_{};  // of the last states of a motion: whether a command came
  std::size_t next_came_ = 0;

  FciMeasured measured_;
  Joints tau_ = Joints::Zero();  // in force, gravity and load excluded
  Joints tau_ext_ = Joints::Zero();
  Jacobian J_;
  Eigen::Isometry3d X_BE_ = Eigen::Isometry3d::Identity();
};

}  // namespace fovea::sim
