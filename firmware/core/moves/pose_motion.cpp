// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/moves/pose_motion.hpp"

#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::moves {
namespace {

using model::Mat3;
using model::Vec3;
using model::Vec6;

constexpr double kLength = 0.3;   // this distance counts as much as one radian [m]
constexpr double kThereM = 1e-5;  // a goal this near is reached
constexpr double kThereRad = 1e-4;
constexpr double kAtRest = 1e-3;  // if no joint is faster [rad/s]

// Displacement and turn from `X` to `X_goal`, in axes of B.
Vec6 Difference(const model::Pose& X_goal, const model::Pose& X) noexcept {
  Vec6 difference;
  difference << X_goal.p - X.p, model::RotationVector(X_goal.R.lazyProduct(X.R.transpose()));
  return difference;
}

}  // namespace

bool ToSetpoint(const MotionCommand& command, PoseSetpoint& setpoint) noexcept {
  if (!model::RotationOfQuaternion(command.quaternion_BE, setpoint.X_BE.R)) {
    return false;
  }
  setpoint.X_BE.p = {command.p_BE[0], command.p_BE[1], command.p_BE[2]};
  for (std::size_t i = 0; i < command.V_BE_B.size(); ++i) {
    setpoint.V_BE_B[static_cast<Eigen::Index>(i)] = command.V_BE_B[i];
  }
  return setpoint.X_BE.p.allFinite() && setpoint.V_BE_B.allFinite();
}

bool PlanPose(const config::ServoConfig& config, const model::Pose& X_BE,
              const trajectory::Reference& reference, trajectory::SynchronisedMove& move) noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  model::Mat6N J;
  model::ComputeBaseJacobian(config.arm, poses, J);
  const Vec6 V = J.lazyProduct(reference.dq);
  Vec6 A = J.lazyProduct(reference.ddq);
  A += model::BiasAcceleration(config.arm, poses, reference.dq);
  const Vec3 phi = model::RotationVector(poses.X_BE.R.lazyProduct(X_BE.R.transpose()));
  const Mat3 rate = model::TurnRateInverse(phi);
  const Vec3 dphi = rate.lazyProduct(V.tail<3>());
  // Leaves out the change of the rate matrix. It matters only if the goal changes during a fast turn, and the
  // guard bounds the resulting jerk.
  const Vec3 ddphi = rate.lazyProduct(A.tail<3>());
  const config::MoveConfig& limits = config.move;
  std::array<trajectory::AxisTask, 6> tasks;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    tasks[k] = {
        {poses.X_BE.p[i] - X_BE.p[i], V[i], A[i]}, 0.0, {limits.speed, limits.acceleration, limits.jerk}};
    tasks[k + 3] = {
        {phi[i], dphi[i], ddphi[i]}, 0.0, {limits.turn_speed, limits.turn_acceleration, limits.turn_jerk}};
  }
  return move.Plan(tasks);
}

PoseSetpoint PoseAt(const model::Pose& X_BE, const trajectory::SynchronisedMove& move, double t) noexcept {
  trajectory::SynchronisedMove::States states;
  move.At(t, states);
  const Vec3 way(states[0].x, states[1].x, states[2].x);
  const Vec3 phi(states[3].x, states[4].x, states[5].x);
  const Vec3 dphi(states[3].v, states[4].v, states[5].v);
  PoseSetpoint setpoint;
  setpoint.is_end = t >= move.Duration();
  setpoint.X_BE = {model::RotationOf(phi).lazyProduct(X_BE.R), X_BE.p + way};
  setpoint.V_BE_B << states[0].v, states[1].v, states[2].v, model::TurnRateMatrix(phi).lazyProduct(dphi);
  return setpoint;
}

hal::LimitSet FollowPose(const config::ServoConfig& config, const PoseSetpoint& setpoint, bool& refused,
                         control::ResolvedMotion& motion, guard::KnownClearances& known,
                         trajectory::Reference& reference) noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  model::Mat6N J;
  model::ComputeBaseJacobian(config.arm, poses, J);
  const model::LinearJacobian J_E_B = J.topRows<3>();
  const Vec6 e = Difference(setpoint.X_BE, poses.X_BE);
  refused = refused || !(e.head<3>().norm() <= config.move.pose_error_max &&
                         e.tail<3>().norm() <= config.move.pose_error_max / kLength);
  if (refused) {
    return guard::GuardMotion(config, guard::MotionWish::Velocity(model::VecN::Zero(config.arm.num_joints)),
                              poses.X_BE.p, J_E_B, known, reference);
  }
  // The reference is one tick late by design; the feedback must not correct that.
  Vec6 V = setpoint.V_BE_B + config.move.pose_gain * (e - hal::kTickPeriodS * setpoint.V_BE_B);
  model::Mat6N J_E;
  model::ComputeJacobian(config.arm, poses, model::Pose{}, J_E);
  J.topRows<3>() /= kLength;
  V.head<3>() /= kLength;
  control::MotionTask task;
  task.J = J;
  task.v = V;
  task.dq_0.setZero(config.arm.num_joints);
  if (!setpoint.is_end) {
    task.dq_0 = control::FreeWish(config.law, config.arm, reference.q, J_E);
  }
  task.weight.setOnes(config.arm.num_joints);
  const model::VecN dq_before = motion.dq;
  control::ResolveMotion(config, task, {reference, poses, J_E_B, J_E}, motion);
  refused = !motion.finite;
  guard::MotionWish wish = guard::MotionWish::Velocity(motion.dq);
  if (dq_before.size() == wish.dq.size()) {
    wish.ddq = (wish.dq - dq_before) / hal::kTickPeriodS;
  }
  return motion.limits | guard::GuardMotion(config, wish, poses.X_BE.p, J_E_B, known, reference);
}

bool StandsAt(const config::ServoConfig& config, const model::Pose& X_BE,
              const trajectory::Reference& reference) noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  const Vec6 e = Difference(X_BE, poses.X_BE);
  return e.head<3>().norm() < kThereM && e.tail<3>().norm() < kThereRad &&
         reference.dq.lpNorm<Eigen::Infinity>() < kAtRest;
}

}  // namespace fovea::moves
