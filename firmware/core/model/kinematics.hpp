// SPDX-License-Identifier: Apache-2.0
// Poses of the arm's links, and how its joints move them.
#pragma once

#include <array>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::model {

// Poses of all links and of the end effector at one q.
struct ArmPoses {
  std::array<Pose, kMaxJoints> X_BL;  // [num_joints] link frames; column 2 of R is the joint's axis
  Pose X_BE;
};

// `q` [num_joints]. A non-finite or huge q gives non-finite poses. Real-time: yes.
void ComputePoses(const ArmModel& model, const VecN& q, ArmPoses& poses) noexcept;

// Body Jacobian of a frame F that is fixed to the end effector: V_BF_F = J_F dq, twist [v; w] of F in B,
// expressed in F, for `X_EF` its pose in E (identity: J_E). `J_F` becomes [6 x num_joints].
// Real-time: yes.
void ComputeJacobian(const ArmModel& model, const ArmPoses& poses, const Pose& X_EF, Mat6N& J_F) noexcept;

// The end effector's Jacobian in axes of B: [v; w] of E's origin = J dq. `J_B` becomes [6 x num_joints].
// Real-time: yes.
void ComputeBaseJacobian(const ArmModel& model, const ArmPoses& poses, Mat6N& J_B) noexcept;

// Velocity of the arm's point at `p_B` [m], in axes of B, per unit of velocity of joint `i`, which must be
// nearer to the base than the point. Real-time: yes.
[[nodiscard]] Vec3 PointVelocity(const ArmModel& model, const ArmPoses& poses, int i,
                                 const Vec3& p_B) noexcept;

using LinearJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints>;

// Velocity of the end effector's point at `p_B` [m], in axes of B: v = J dq. `J_B` becomes
// [3 x num_joints]. Real-time: yes.
void ComputeLinearJacobian(const ArmModel& model, const ArmPoses& poses, const Vec3& p_B,
                           LinearJacobian& J_B) noexcept;

// The end effector's acceleration from the joints' velocities alone: dJ/dt dq [m/s^2, rad/s^2], linear first,
// of E's origin, in axes of B. Real-time: yes.
[[nodiscard]] Vec6 BiasAcceleration(const ArmModel& model, const ArmPoses& poses, const VecN& dq) noexcept;

// The velocity of that point for the joint velocities `dq`, without its Jacobian [m/s]. Real-time: yes.
[[nodiscard]] Vec3 LinearVelocity(const ArmModel& model, const ArmPoses& poses, const Vec3& p_B,
                                  const VecN& dq) noexcept;

// The end effector's angular velocity in axes of B [rad/s], for the joint velocities `dq`. Real-time: yes.
[[nodiscard]] Vec3 AngularVelocity(const ArmModel& model, const ArmPoses& poses, const VecN& dq) noexcept;

// dJ_j/dq_k for body Jacobian columns `J_j`, `J_k` (any fixed frame of the end effector): the Lie bracket
// [J_j, J_k] for k > j, because joint k moves the frame relative to joint j's axis; zero otherwise.
// Real-time: yes.
[[nodiscard]] inline Vec6 ColumnChange(const Mat6N& J, int j, int k) noexcept {
  Vec6 change = Vec6::Zero();
  if (k > j) {
    const Vec3 w_j = J.col(j).tail<3>();
    const Vec3 w_k = J.col(k).tail<3>();
    const Vec3 v_j = J.col(j).head<3>();
    const Vec3 v_k = J.col(k).head<3>();
    change.head<3>() = Cross(w_j, v_k) + Cross(v_j, w_k);
    change.tail<3>() = Cross(w_j, w_k);
  }
  return change;
}

}  // namespace fovea::model
