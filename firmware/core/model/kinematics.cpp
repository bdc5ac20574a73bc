// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/kinematics.hpp"

#include "firmware/core/model/math.hpp"

namespace fovea::model {
namespace {

// True for a turn about x, as between most joints of a robot description.
bool TurnsAboutX(const Mat3& R) noexcept {
  return R(0, 0) == 1.0 && R(1, 0) == 0.0 && R(2, 0) == 0.0 && R(0, 1) == 0.0 && R(0, 2) == 0.0;
}

// R_BL = R_BP R_PL, without the terms that are zero if R_PL is a turn about x.
void Turn(const Mat3& R_BP, const Mat3& R_PL, Mat3& R_BL) noexcept {
  if (!TurnsAboutX(R_PL)) {
    R_BL.noalias() = R_BP.lazyProduct(R_PL);
    return;
  }
  R_BL.col(0) = R_BP.col(0);
  for (int i = 1; i < 3; ++i) {
    R_BL.col(i) = R_PL(1, i) * R_BP.col(1) + R_PL(2, i) * R_BP.col(2);
  }
}

// PointVelocity, for the loops below: there it is worth its place in each of them.
inline Vec3 VelocityOfPoint(const ArmModel& model, const ArmPoses& poses, int i, const Vec3& p_B) noexcept {
  const auto k = static_cast<std::size_t>(i);
  const Vec3 axis_B = poses.X_BL[k].R.col(2);
  if (model.joints[k].type == JointType::kPrismatic) {
    return axis_B;
  }
  return Cross(axis_B, p_B - poses.X_BL[k].p);
}

}  // namespace

Vec3 PointVelocity(const ArmModel& model, const ArmPoses& poses, int i, const Vec3& p_B) noexcept {
  return VelocityOfPoint(model, poses, i, p_B);
}

void ComputePoses(const ArmModel& model, const VecN& q, ArmPoses& poses) noexcept {
  const Pose base;
  const Pose* X_BP = &base;  // of the link before
  for (int i = 0; i < model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Joint& joint = model.joints[k];
    // The joint's frame at q = 0, in B.
    Pose& X_BL = poses.X_BL[k];
    Turn(X_BP->R, joint.X_PJ.R, X_BL.R);
    X_BL.p.noalias() = X_BP->p + X_BP->R.lazyProduct(joint.X_PJ.p);
    if (joint.type == JointType::kRevolute) {
      // A turn about z mixes the first two columns and leaves the third.
      const auto [s, c] = SinCos(q[i]);
      const Vec3 x = X_BL.R.col(0);
      const Vec3 y = X_BL.R.col(1);
      X_BL.R.col(0) = c * x + s * y;
      X_BL.R.col(1) = c * y - s * x;
    } else {
      X_BL.p += q[i] * X_BL.R.col(2);
    }
    X_BP = &X_BL;
  }
  poses.X_BE = *X_BP * model.X_LnE;
}

void ComputeJacobian(const ArmModel& model, const ArmPoses& poses, const Pose& X_EF, Mat6N& J_F) noexcept {
  const Pose X_BF = poses.X_BE * X_EF;
  const Mat3 R_FB = X_BF.R.transpose();
  J_F.resize(6, model.num_joints);
  for (int i = 0; i < model.num_joints; ++i) {
    J_F.col(i).head<3>() = R_FB * VelocityOfPoint(model, poses, i, X_BF.p);
    if (model.joints[static_cast<std::size_t>(i)].type == JointType::kRevolute) {
      J_F.col(i).tail<3>() = R_FB * poses.X_BL[static_cast<std::size_t>(i)].R.col(2);
    } else {
      J_F.col(i).tail<3>().setZero();
    }
  }
}

void ComputeLinearJacobian(const ArmModel& model, const ArmPoses& poses, const Vec3& p_B,
                           LinearJacobian& J_B) noexcept {
  J_B.resize(3, model.num_joints);
  for (int i = 0; i < model.num_joints; ++i) {
    J_B.col(i) = VelocityOfPoint(model, poses, i, p_B);
  }
}

Vec3 LinearVelocity(const ArmModel& model, const ArmPoses& poses, const Vec3& p_B, const VecN& dq) noexcept {
  Vec3 v_B = model.num_joints > 0 ? Vec3(dq[0] * VelocityOfPoint(model, poses, 0, p_B)) : Vec3::Zero();
  for (int i = 1; i < model.num_joints; ++i) {
    v_B += dq[i] * VelocityOfPoint(model, poses, i, p_B);
  }
  return v_B;
}

Vec3 AngularVelocity(const ArmModel& model, const ArmPoses& poses, const VecN& dq) noexcept {
  Vec3 w_B = Vec3::Zero();
  for (int i = 0; i < model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (model.joints[k].type == JointType::kRevolute) {
      w_B += dq[i] * poses.X_BL[k].R.col(2);
    }
  }
  return w_B;
}

void ComputeBaseJacobian(const ArmModel& model, const ArmPoses& poses, Mat6N& J_B) noexcept {
  J_B.resize(6, model.num_joints);
  for (int i = 0; i < model.num_joints; ++i) {
    const Pose& X_BL = poses.X_BL[static_cast<std::size_t>(i)];
    const Vec3 axis = X_BL.R.col(2);
    if (model.joints[static_cast<std::size_t>(i)].type == JointType::kRevolute) {
      J_B.col(i).head<3>() = Cross(axis, poses.X_BE.p - X_BL.p);
      J_B.col(i).tail<3>() = axis;
    } else {
      J_B.col(i).head<3>() = axis;
      J_B.col(i).tail<3>().setZero();
    }
  }
}

Vec6 BiasAcceleration(const ArmModel& model, const ArmPoses& poses, const VecN& dq) noexcept {
  // Joint by joint outwards: angular velocity w and acceleration alpha, and acceleration a of the point at p.
  Vec3 w = Vec3::Zero();
  Vec3 alpha = Vec3::Zero();
  Vec3 a = Vec3::Zero();
  Vec3 p = Vec3::Zero();
  const auto move_to = [&](const Vec3& to) {
    const Vec3 r = to - p;
    a += Cross(alpha, r) + Cross(w, Cross(w, r));
    p = to;
  };
  for (int i = 0; i < model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 axis = poses.X_BL[k].R.col(2);
    move_to(poses.X_BL[k].p);
    if (model.joints[k].type == JointType::kRevolute) {
      alpha += Cross(w, axis) * dq[i];
      w += axis * dq[i];
    } else {
      a += 2.0 * Cross(w, axis) * dq[i];  // Coriolis, of the link that slides along the turning axis
    }
  }
  move_to(poses.X_BE.p);
  Vec6 bias;
  bias << a, alpha;
  return bias;
}

}  // namespace fovea::model
