// SPDX-License-Identifier: Apache-2.0
// Uses the servo's own model (firmware/core/model), compiled in: a client needs no other file to load it.
#include "sim/model_library/panda_model.hpp"

#include "emitted/panda.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/load.hpp"

namespace {

using namespace fovea::model;  // the whole file is this model

constexpr int kJoints = 7;
constexpr int kFlange = 8;
constexpr int kEndEffector = 9;

ArmModel Panda() {
  ArmModel arm;
  fovea::arms::LoadPanda(arm);
  return arm;
}

ArmModel PandaWith(const double* I_load, double m_load, const double* F_x_Cload) {
  ArmModel arm = Panda();
  if (m_load > 0.0) {
    Load load;
    load.mass = m_load;
    load.p_ECom = Eigen::Map<const Vec3>(F_x_Cload);
    load.I_Com_E = I_load == nullptr ? Mat3::Zero() : Mat3(Eigen::Map<const Mat3>(I_load));
    Attach(load, arm);
  }
  return arm;
}

VecN Joints(const double* values) { return Eigen::Map<const VecN>(values, kJoints); }

Pose PoseOf(const double* matrix) {
  const Eigen::Map<const Eigen::Matrix4d> X(matrix);
  return {X.topLeftCorner<3, 3>(), X.topRightCorner<3, 1>()};
}

Pose FramePose(const ArmPoses& poses, int frame, const double* F_T_EE) {
  if (frame < kFlange) {
    return poses.X_BL[static_cast<std::size_t>(frame - 1)];
  }
  return frame == kFlange ? poses.X_BE : poses.X_BE * PoseOf(F_T_EE);
}

void WritePose(const double* q, int frame, const double* F_T_EE, double* out) {
  ArmPoses poses;
  ComputePoses(Panda(), Joints(q), poses);
  const Pose X = FramePose(poses, frame, F_T_EE);
  Eigen::Map<Eigen::Matrix4d> matrix(out);
  matrix.setIdentity();
  matrix.topLeftCorner<3, 3>() = X.R;
  matrix.topRightCorner<3, 1>() = X.p;
}

void WriteJacobian(const double* q, int frame, const double* F_T_EE, bool in_frame, double* out) {
  ArmPoses poses;
  ComputePoses(Panda(), Joints(q), poses);
  const Pose X = FramePose(poses, frame, F_T_EE);
  Eigen::Map<Eigen::Matrix<double, 6, kJoints>> J(out);
  J.setZero();
  for (int i = 0; i < (frame < kFlange ? frame : kJoints); ++i) {
    const Pose& link = poses.X_BL[static_cast<std::size_t>(i)];
    const Vec3 axis = link.R.col(2);
    const Vec3 v = Cross(axis, X.p - link.p);
    J.col(i).head<3>() = in_frame ? Vec3(X.R.transpose() * v) : v;
    J.col(i).tail<3>() = in_frame ? Vec3(X.R.transpose() * axis) : axis;
  }
}

constexpr double kAnyPosture[kJoints] = {};  // the first joint's Jacobians do not depend on it

}  // namespace

#define FOVEA_FRAME(n)                                                                                \
  void O_T_J##n(const double* q, double* pose) { WritePose(q, n, nullptr, pose); }                    \
  void O_J_J##n(const double* q, double* jacobian) { WriteJacobian(q, n, nullptr, false, jacobian); } \
  void Ji_J_J##n(const double* q, double* jacobian) { WriteJacobian(q, n, nullptr, true, jacobian); }

void O_T_J1(const double* q, double* pose) { WritePose(q, 1, nullptr, pose); }
void O_J_J1(double* jacobian) { WriteJacobian(kAnyPosture, 1, nullptr, false, jacobian); }
void Ji_J_J1(double* jacobian) { WriteJacobian(kAnyPosture, 1, nullptr, true, jacobian); }
FOVEA_FRAME(2)
FOVEA_FRAME(3)
FOVEA_FRAME(4)
FOVEA_FRAME(5)
FOVEA_FRAME(6)
FOVEA_FRAME(7)
FOVEA_FRAME(8)
void O_T_J9(const double* q, const double* F_T_EE, double* pose) { WritePose(q, kEndEffector, F_T_EE, pose); }
void O_J_J9(const double* q, const double* F_T_EE, double* jacobian) {
  WriteJacobian(q, kEndEffector, F_T_EE, false, jacobian);
}
void Ji_J_J9(const double* q, const double* F_T_EE, double* jacobian) {
  WriteJacobian(q, kEndEffector, F_T_EE, true, jacobian);
}

void M_NE(const double* q, const double* I_load, double m_load, const double* F_x_Cload, double* M) {
  const ArmModel arm = PandaWith(I_load, m_load, F_x_Cload);
  ArmPoses poses;
  ArmDynamics dynamics;
  ComputePoses(arm, Joints(q), poses);
  ComputeDynamics(arm, poses, VecN::Zero(kJoints), dynamics);
  Eigen::Map<Eigen::Matrix<double, kJoints, kJoints>> out(M);
  out = dynamics.M;
}

void c_NE(const double* q, const double* dq, const double* I_load, double m_load, const double* F_x_Cload,
          double* c) {
  const ArmModel arm = PandaWith(I_load, m_load, F_x_Cload);
  ArmPoses poses;
  ArmDynamics dynamics;
  ComputePoses(arm, Joints(q), poses);
  ComputeDynamics(arm, poses, Joints(dq), dynamics);
  Eigen::Map<Eigen::Matrix<double, kJoints, 1>> out(c);
  out = dynamics.Cdq;
}

void g_NE(const double* q, const double* g_earth, double m_load, const double* F_x_Cload, double* g) {
  ArmModel arm = PandaWith(nullptr, m_load, F_x_Cload);
  arm.g_B = Eigen::Map<const Vec3>(g_earth);
  ArmPoses poses;
  ArmDynamics dynamics;
  ComputePoses(arm, Joints(q), poses);
  ComputeDynamics(arm, poses, VecN::Zero(kJoints), dynamics);
  Eigen::Map<Eigen::Matrix<double, kJoints, 1>> out(g);
  out = dynamics.g;
}
