// SPDX-License-Identifier: Apache-2.0
// The simulated Panda behind its network interface: modes, motions, errors and internal controllers.
//
// Has no socket: requests and commands are plain data, one step per millisecond. External torques are
// computed from the physics: the torques that the motion needs beyond the command.
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
  // `robot` is the arm in `world` as its own controller believes it to be: seven joints, and fixed links for
  // its tools. `world` must outlive this. The end effector may not enter `walls`.
  FciRobot(World& world, const SimRobot& robot, std::vector<CartesianWall> walls = {});

  [[nodiscard]] franka::SetterStatus Set(franka::Command command, std::span<const std::byte> payload);
  // The wall with number `id` of GetCartesianLimit.
  [[nodiscard]] std::optional<CartesianWall> Wall(int id) const;
  // Returns kMotionStarted, or the reason for a refusal.
  [[nodiscard]] franka::MoveStatus Move(const franka::MoveRequest& request);
  [[nodiscard]] franka::StopStatus StopMove();
  [[nodiscard]] franka::RecoveryStatus Recover();
  // The client disconnected: ends a motion; the robot holds its position.
  void Abandon();
  // The stop button. Pressed: the robot stops. Released: the robot is idle without errors; a joint outside
  // its limits counts as moved back by hand.
  void UserStop(bool pressed);

  // The enabling button at the hand. Pressed while the robot is idle, user stopped or stopped by a reflex: a
  // person can guide the hand as SetGuidingMode allows. Released: the robot holds there, in its previous
  // mode. The button has no effect in a motion.
  void PressGuiding(bool pressed);
  // From now on, a person pulls at the end effector with `force_B` [N, in axes of B].
  void PullHand(const Eigen::Vector3d& force_B) { hand_force_B_ = force_B; }

  // Steps one millisecond. `command` is empty outside a motion, or if the command is missing.
  void Step(const std::optional<franka::RobotCommand>& command);

  [[nodiscard]] const franka::RobotState& state() const { return state_; }
  [[nodiscard]] bool moving() const { return state_.robot_mode == franka::RobotMode::kMove; }
  // Whether a command of the present motion has arrived.
  [[nodiscard]] bool commanded() const { return commanded_; }
  // The end status of the last motion; returned only once.
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
  int missing_ = 0;               // missing commands in a row
  int waited_ = 0;                // states of this motion before its first command
  std::array<bool, 100> came_{};  // whether a command came, for the last states of the motion
  std::size_t next_came_ = 0;

  SelfDistance self_distance_;
  std::vector<CartesianWall> walls_;
  SwingWatch swing_watch_;  // of the present motion
  Eigen::Vector3d hand_force_B_ = Eigen::Vector3d::Zero();
  struct Guiding {
    franka::RobotMode from = franka::RobotMode::kIdle;  // previous mode
    Joints q_begin = Joints::Zero();
    double beyond = 0.0;   // least distance of a joint outside its range since guiding began [rad]
    bool in_wall = false;  // the hand has been inside a wall since guiding began
  };
  Guiding guiding_;

  FciMeasured measured_;
  Joints tau_ = Joints::Zero();  // active command, without gravity and load
  Joints tau_ext_ = Joints::Zero();
  Jacobian J_;
  Eigen::Isometry3d X_BE_ = Eigen::Isometry3d::Identity();
};

}  // namespace fovea::sim
