// Where the robot's own controller wants the arm: what a motion generator commands, checked, or a way to
// rest.
//
// Each command is a step of 1 ms. A command that is missing is replaced: the motion goes on at constant
// acceleration.
#pragma once

#include <optional>

#include "fovea/franka/errors.hpp"
#include "fovea/franka/messages.hpp"
#include "sim/panda/types.hpp"
#include "sim/robot/chain.hpp"

namespace fovea::sim {

// Position and two derivatives of each joint.
struct JointReference {
  Joints q = Joints::Zero();
  Joints dq = Joints::Zero();
  Joints ddq = Joints::Zero();
};

// The same of the end effector EE and of the elbow, in O.
struct CartesianReference {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Twist V = Twist::Zero();
  Twist A = Twist::Zero();
  Eigen::Vector3d elbow = Eigen::Vector3d::Zero();  // angle of joint 3, its velocity, its acceleration
  double elbow_sign = -1.0;                         // of joint 4
};

class FciReference {
 public:
  explicit FciReference(const Chain& chain) : chain_(chain) {}

  // Holds `q`, which moves with `dq` for now: comes to rest from there as fast as the joints may.
  void Hold(const Joints& q, const Joints& dq);
  void StepToRest();

  // A motion begins, with the end effector's frame at F_T_EE for all its length.
  void Begin(franka::MoveGenerator generator, const Eigen::Isometry3d& F_T_EE,
             const franka::Filters& filters);
  // One step of it; the error when the command is not allowed, and then nothing has moved.
  [[nodiscard]] std::optional<franka::Error> Step(const franka::RobotCommand& command);
  // The error when it may not end here: it could not come to rest within one step.
  [[nodiscard]] std::optional<franka::Error> Finish() const;
  // One step without a command.
  [[nodiscard]] std::optional<franka::Error> Extrapolate();

  [[nodiscard]] const JointReference& joints() const { return joints_; }
  [[nodiscard]] const CartesianReference& cartesian() const { return cartesian_; }

 private:
  [[nodiscard]] std::optional<franka::Error> StepJoints(const Joints& q, const Joints& dq);
  [[nodiscard]] std::optional<franka::Error> StepPose(const Eigen::Isometry3d& X_next, const Twist& V,
                                                      const std::optional<franka::Vector2>& elbow);
  [[nodiscard]] std::optional<franka::Error> CheckStart(const franka::RobotCommand& command) const;
  [[nodiscard]] std::optional<Joints> Solve(const Eigen::Isometry3d& X_goal,
                                            const std::optional<double>& elbow) const;
  [[nodiscard]] bool IsCartesian() const;

  const Chain& chain_;
  franka::MoveGenerator generator_ = franka::MoveGenerator::kJointVelocity;
  franka::Filters filters_;
  Eigen::Isometry3d F_T_EE_ = Eigen::Isometry3d::Identity();
  bool first_ = true;  // no command of this motion has come
  bool elbow_given_ = false;
  JointReference joints_;
  CartesianReference cartesian_;
};

}  // namespace fovea::sim
