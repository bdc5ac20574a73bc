// SPDX-License-Identifier: Apache-2.0
// The reference of the robot's own controllers: the checked commands of a motion generator, or a path to
// rest.
//
// Each command is a step of 1 ms. For a missing command, the motion continues at constant acceleration.
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

// The same for the end effector EE and for the elbow, in O.
struct CartesianReference {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Twist V = Twist::Zero();
  Twist A = Twist::Zero();
  Eigen::Vector3d elbow = Eigen::Vector3d::Zero();  // angle of joint 3, its velocity, its acceleration
  double elbow_sign = -1.0;                         // sign of joint 4
};

class FciReference {
 public:
  explicit FciReference(const Chain& chain) : chain_(chain) {}

  // Comes to rest from `q` and `dq` as fast as the joints' acceleration limits allow.
  void Hold(const Joints& q, const Joints& dq);
  void StepToRest();

  // Begins a motion. The end effector's frame stays at F_T_EE for the whole motion.
  void Begin(franka::MoveGenerator generator, const Eigen::Isometry3d& F_T_EE,
             const franka::Filters& filters);
  // Takes one step. Returns the error of a command that is not allowed; the reference then stays unchanged.
  [[nodiscard]] std::optional<franka::Error> Step(const franka::RobotCommand& command);
  // Returns the error if the motion may not end here: it could not come to rest within one step.
  [[nodiscard]] std::optional<franka::Error> Finish() const;
  // Takes one step without a command.
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
  bool first_ = true;  // no command of this motion has arrived
  bool elbow_given_ = false;
  JointReference joints_;
  CartesianReference cartesian_;
};

}  // namespace fovea::sim
