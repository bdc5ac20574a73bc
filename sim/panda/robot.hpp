// The simulated Panda as its network interface shows it: modes, motions, errors, and the controllers inside.
//
// No socket here: requests and commands come as plain data, a millisecond at a time. What the robot feels
// from outside is taken from the physics: what its motion needs beyond its own command.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "fovea/franka/errors.hpp"
#include "fovea/franka/messages.hpp"
#include "sim/panda/cartesian_wall.hpp"
#include "sim/panda/controller.hpp"
#include "sim/panda/reference.hpp"
#include "sim/panda/self_distance.hpp"
#include "sim/panda/settings.hpp"
#include "sim/panda/swing_watch.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class FciRobot {
 public:
  // `robot` is the arm in `world`, of seven joints, with what it carries as links of its own; both outlive
  // this. The end effector may not enter `walls`.
  FciRobot(World& world, const SimRobot& robot, std::vector<CartesianWall> walls = {});

  [[nodiscard]] franka::SetterStatus Set(franka::Command command, std::span<const std::byte> payload);
  // The wall that GetCartesianLimit calls `id`.
  [[nodiscard]] std::optional<CartesianWall> Wall(int id) const;
  // kMotionStarted, or why not.
  [[nodiscard]] franka::MoveStatus Move(const franka::MoveRequest& request);
  [[nodiscard]] franka::StopStatus StopMove();
  [[nodiscard]] franka::RecoveryStatus Recover();
  // The client is gone: a motion ends, the robot holds.
  void Abandon();
  // The stop button: pressed, all stops; released, the robot is idle and without error, and joints that were
  // outside their limits have been put back by hand.
  void UserStop(bool pressed);

  // The enabling button at the hand. Pressed while the robot is idle, user stopped or stopped by a reflex, it
  // leaves the hand to who guides it, as SetGuidingMode says; let go, the robot holds there, in the mode that
  // it came from. In a motion the button does nothing.
  void PressGuiding(bool pressed);
  // Somebody pulls at the end effector with `force_B` [N, in axes of B] from now on.
  void PullHand(const Eigen::Vector3d& force_B) { hand_force_B_ = force_B; }

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
  void FinishMotion();
  void ApplyTorque(const franka::RobotCommand& command);
  void End(franka::MoveStatus status, franka::RobotMode mode);
  void Reflex(franka::Error error);
  void PullAtJoints();
  [[nodiscard]] Eigen::Isometry3d F_T_EE() const {
    return ToPose(settings_.F_T_NE.pose) * ToPose(settings_.NE_T_EE.pose);
  }
  [[nodiscard]] double JointsBeyond() const;
  [[nodiscard]] bool IsInWall() const;
  [[nodiscard]] bool MeetsItself() const;
  [[nodiscard]] std::optional<franka::Error> SpeedError() const;
  void CheckMotion();
  void CheckGuiding();
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

  SelfDistance self_distance_;
  std::vector<CartesianWall> walls_;
  SwingWatch swing_watch_;  // of the present motion
  Eigen::Vector3d hand_force_B_ = Eigen::Vector3d::Zero();
  struct Guiding {
    franka::RobotMode from = franka::RobotMode::kIdle;  // the mode that it came from
    Joints q_begin = Joints::Zero();
    double beyond = 0.0;   // how far a joint has been outside, at the least [rad]
    bool in_wall = false;  // since it began
  };
  Guiding guiding_;

  FciMeasured measured_;
  Joints tau_ = Joints::Zero();  // in force, gravity and load excluded
  Joints tau_ext_ = Joints::Zero();
  Jacobian J_;
  Eigen::Isometry3d X_BE_ = Eigen::Isometry3d::Identity();
};

}  // namespace fovea::sim
