// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/robot.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

namespace fovea::sim {
namespace {

using franka::ControllerMode;
using franka::Error;
using franka::MotionGeneratorMode;
using franka::MoveController;
using franka::MoveStatus;
using franka::RobotMode;

constexpr double kStillSpeed = 0.05;    // a measured joint is at rest up to this speed [rad/s]
constexpr int kPatienceForFirst = 200;  // the first command of a motion must arrive within this many states

ControllerMode Shown(MoveController controller) { return static_cast<ControllerMode>(controller); }
MotionGeneratorMode Shown(franka::MoveGenerator generator) {
  return static_cast<MotionGeneratorMode>(static_cast<int>(generator) + 1);
}

}  // namespace

FciRobot::FciRobot(World& world, const SimRobot& robot, std::vector<CartesianWall> walls)
    : world_(world), chain_(robot), reference_(chain_), self_distance_(robot), walls_(std::move(walls)) {
  Measure(world_.Reading(), world_.ReadingSpeed());
  reference_.Hold(measured_.q, Joints::Zero());
  state_.robot_mode = RobotMode::kIdle;
  state_.controller_mode = ControllerMode::kOther;
  state_.O_ddP_O = {0.0, 0.0, -9.81};
  ShowMounted(robot);
  Show();
}

// The links fixed to the flange are the end effector. The robot's own gravity compensation includes it.
void FciRobot::ShowMounted(const SimRobot& robot) {
  for (const SimLink& link : robot.links) {
    if (link.parent == robot.tip && link.mass > 0.0) {
      const Eigen::Isometry3d X_FCom = link.X_PL * link.X_LCom;
      const Eigen::Matrix3d I_F = X_FCom.linear() * link.I_Com * X_FCom.linear().transpose();
      state_.m_ee = link.mass;
      state_.F_x_Cee = ToArray(Eigen::Vector3d(X_FCom.translation()));
      Eigen::Map<Eigen::Matrix3d>(state_.I_ee.data()) = I_F;
    }
  }
}

franka::SetterStatus FciRobot::Set(franka::Command command, std::span<const std::byte> payload) {
  if (moving()) {
    return franka::SetterStatus::kNotPossibleNow;
  }
  const franka::SetterStatus status = ApplySetter(command, payload, settings_);
  Show();
  return status;
}

std::optional<CartesianWall> FciRobot::Wall(int id) const {
  const auto k = static_cast<std::size_t>(id);
  return id >= 0 && k < walls_.size() ? std::optional(walls_[k]) : std::nullopt;
}

MoveStatus FciRobot::Move(const franka::MoveRequest& request) {
  if (state_.robot_mode != RobotMode::kIdle) {
    return MoveStatus::kNotPossible;
  }
  const auto valid = [](const franka::Vector3& most) {
    return std::all_of(most.begin(), most.end(), [](double v) { return v >= 0.0; });
  };
  if (request.controller > MoveController::kExternal ||
      request.generator > franka::MoveGenerator::kCartesianVelocity || !valid(request.max_path_deviation) ||
      !valid(request.max_goal_deviation)) {
    return MoveStatus::kInvalidArgument;
  }
  move_ = request;
  move_end_.reset();
  reference_.Begin(request.generator, F_T_EE(), settings_.filters);
  commanded_ = false;
  missing_ = 0;
  waited_ = 0;
  came_.fill(false);
  swing_watch_.Clear();
  state_.reflex_reason = {};
  state_.robot_mode = RobotMode::kMove;
  state_.controller_mode = Shown(request.controller);
  state_.motion_generator_mode = Shown(request.generator);
  return MoveStatus::kMotionStarted;
}

franka::StopStatus FciRobot::StopMove() {
  if (!moving()) {
    return franka::StopStatus::kNotPossible;
  }
  End(MoveStatus::kPreempted, RobotMode::kIdle);
  return franka::StopStatus::kSuccess;
}

franka::RecoveryStatus FciRobot::Recover() {
  if (state_.robot_mode == RobotMode::kUserStopped) {
    return franka::RecoveryStatus::kEmergencyAborted;
  }
  if (moving() || state_.robot_mode == RobotMode::kGuiding) {
    return franka::RecoveryStatus::kNotPossible;
  }
  if (JointsBeyond() > fci_limits::kBeyond || IsInWall()) {
    return franka::RecoveryStatus::kManualRecoveryRequired;
  }
  state_.errors = {};
  state_.robot_mode = RobotMode::kIdle;
  return franka::RecoveryStatus::kSuccess;
}

void FciRobot::Abandon() {
  if (moving()) {
    End(MoveStatus::kAborted, RobotMode::kIdle);
  }
  move_end_.reset();
}

void FciRobot::UserStop(bool pressed) {
  if (pressed) {
    End(MoveStatus::kEmergencyAborted, RobotMode::kUserStopped);
    return;
  }
  if (state_.robot_mode == RobotMode::kGuiding && guiding_.from == RobotMode::kUserStopped) {
    guiding_.from = RobotMode::kIdle;
    state_.errors = {};
  } else if (state_.robot_mode == RobotMode::kUserStopped) {
    state_.errors = {};
    state_.robot_mode = RobotMode::kIdle;
    constexpr double kInside = 0.02;
    const Joints inside = Joints::Constant(kInside);
    reference_.Hold(measured_.q.cwiseMin(fci_limits::kQMax - inside).cwiseMax(fci_limits::kQMin + inside),
                    Joints::Zero());
  }
}

std::optional<MoveStatus> FciRobot::TakeMoveEnd() { return std::exchange(move_end_, std::nullopt); }

// Ends a motion or guiding. The arm comes to rest from its present state.
void FciRobot::End(MoveStatus status, RobotMode mode) {
  if (moving()) {
    move_end_ = status;
    const bool external = move_.controller == MoveController::kExternal;
    const JointReference& r = reference_.joints();
    reference_.Hold(external ? measured_.q : r.q, external ? measured_.dq : r.dq);
    state_.control_command_success_rate = 0.0;
  } else if (state_.robot_mode == RobotMode::kGuiding) {
    reference_.Hold(measured_.q, measured_.dq);
  }
  commanded_ = false;
  state_.robot_mode = mode;
  state_.controller_mode = ControllerMode::kOther;
  state_.motion_generator_mode = MotionGeneratorMode::kIdle;
}

void FciRobot::Reflex(Error error) {
  state_.errors[static_cast<std::size_t>(error)] = 1;
  state_.reflex_reason[static_cast<std::size_t>(error)] = 1;
  End(MoveStatus::kReflexAborted, RobotMode::kReflex);
}

void FciRobot::Step(const std::optional<franka::RobotCommand>& command) {
  if (moving()) {
    ApplyCommand(command);
  }
  if (state_.robot_mode == RobotMode::kGuiding) {
    reference_.Hold(measured_.q, Joints::Zero());
  } else if (!moving()) {
    reference_.StepToRest();
  }
  if (!moving() || move_.controller != MoveController::kExternal || !commanded_) {
    const Joints most = fci_limits::kTau;
    tau_ = ControllerTorque().cwiseMax(-most).cwiseMin(most);
  }
  const Joints q_before = world_.Reading();
  const Joints dq_before = world_.ReadingSpeed();
  hal::ArmCommand to_arm;
  to_arm.num_joints = franka::kJoints;
  Eigen::Map<Joints>(to_arm.tau_cmd.data()) = tau_ + LoadTorque();
  world_.Command(to_arm);
  PullAtJoints();
  world_.AdvanceTo(world_.now_ns() + hal::kTickPeriodNs);
  Measure(q_before, dq_before);
  if (moving()) {
    CheckMotion();
  } else if (state_.robot_mode == RobotMode::kGuiding) {
    CheckGuiding();
  }
  Show();
}

void FciRobot::ApplyCommand(const std::optional<franka::RobotCommand>& command) {
  if (!command) {
    if (!commanded_) {
      if (++waited_ > kPatienceForFirst) {
        Reflex(Error::kCommunicationConstraints);
      }
      return;
    }
    CountCommand(false);
    if (++missing_ >= fci_limits::kMissingToStop) {
      Reflex(Error::kCommunicationConstraints);
    } else if (const auto error = reference_.Extrapolate()) {
      Reflex(*error);
    }
    return;
  }
  missing_ = 0;
  commanded_ = true;
  CountCommand(true);
  if (command->motion_generation_finished != 0) {
    FinishMotion();
    return;
  }
  if (const auto error = reference_.Step(*command)) {
    Reflex(*error);
    return;
  }
  if (move_.controller == MoveController::kExternal) {
    ApplyTorque(*command);
  }
}

// Success at rest, a reflex in motion. With a client's own controller, only the measured speed shows motion.
void FciRobot::FinishMotion() {
  const bool external = move_.controller == MoveController::kExternal;
  if (const auto error = reference_.Finish()) {
    Reflex(*error);
  } else if (external && measured_.dq.cwiseAbs().maxCoeff() > kStillSpeed) {
    Reflex(Error::kJointVelocityDiscontinuity);
  } else {
    CheckDeviation(move_.max_goal_deviation, Error::kMaxGoalPoseDeviation);
  }
  if (moving()) {
    End(MoveStatus::kSuccess, RobotMode::kIdle);
  }
}

void FciRobot::ApplyTorque(const franka::RobotCommand& command) {
  const Joints tau = ToVector(command.tau_J_d);
  const Joints step = tau - tau_;
  if (!tau.allFinite() || step.cwiseAbs().maxCoeff() > fci_limits::kRounding * fci_limits::kTorqueStep) {
    Reflex(Error::kControllerTorqueDiscontinuity);
    return;
  }
  const double cutoff_hz = settings_.filters.controller;
  if (cutoff_hz >= 1000.0) {
    tau_ = tau;
  } else {
    const double w = 2.0 * std::numbers::pi * cutoff_hz * kFciStepS;
    tau_ += w / (1.0 + w) * step;
  }
}

void FciRobot::CountCommand(bool came) {
  came_[next_came_] = came;
  next_came_ = (next_came_ + 1) % came_.size();
  state_.control_command_success_rate =
      static_cast<double>(std::count(came_.begin(), came_.end(), true)) / static_cast<double>(came_.size());
}

Joints FciRobot::ControllerTorque() const {
  if (state_.robot_mode == RobotMode::kGuiding) {
    return GuidingTorque(chain_, measured_, guiding_.q_begin, F_T_EE(), settings_.guiding);
  }
  if (moving() && move_.controller == MoveController::kCartesianImpedance) {
    return CartesianImpedanceTorque(chain_, measured_, reference_.joints(),
                                    F_T_EE() * ToPose(settings_.EE_T_K.pose), settings_.cartesian_impedance);
  }
  return JointImpedanceTorque(measured_, reference_.joints(), settings_.joint_impedance);
}

// The gravity torque of the load given by SetLoad, whether or not that load exists.
Joints FciRobot::LoadTorque() const {
  const Eigen::Vector3d arm = X_BE_.linear() * ToVector(settings_.load.F_x_Cload);
  Joints tau;
  for (int i = 0; i < franka::kJoints; ++i) {
    const Eigen::Vector3d v = J_.col(i).head<3>() + J_.col(i).tail<3>().cross(arm);
    tau[i] = -settings_.load.mass * ToVector(state_.O_ddP_O).dot(v);
  }
  return tau;
}

}  // namespace fovea::sim
