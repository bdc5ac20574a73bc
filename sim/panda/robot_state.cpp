// SPDX-License-Identifier: Apache-2.0
// The robot's measurements and the state that it reports.
#include <cmath>
#include <numbers>

#include "sim/panda/robot.hpp"

namespace fovea::sim {
namespace {

constexpr double kForceFilterHz = 30.0;  // low pass of the external torques
constexpr double kStill = 1e-3;          // below this the reference does not accelerate [rad/s^2]

template <std::size_t n>
void Flag(const std::array<double, n>& force, const std::array<double, n>& threshold,
          std::array<double, n>& flags) {
  for (std::size_t i = 0; i < n; ++i) {
    flags[i] = std::fabs(force[i]) > threshold[i] ? 1.0 : 0.0;
  }
}

}  // namespace

// Reads the arm's sensors and estimates external forces from the motion.
void FciRobot::Measure(const Joints& q_before, const Joints& dq_before) {
  const hal::ArmState& sensed = world_.MeasuredState();
  measured_.q = Eigen::Map<const Joints>(sensed.q.data());
  measured_.dq = Eigen::Map<const Joints>(sensed.dq.data());
  measured_.M = chain_.MassMatrix(measured_.q);
  measured_.Cdq = chain_.CoriolisTorque(measured_.q, measured_.dq);
  X_BE_ = chain_.TipPose(measured_.q, J_);
  const Joints tau_J = Eigen::Map<const Joints>(sensed.tau_meas.data());
  state_.dtau_J = ToArray(Joints((tau_J - ToVector(state_.tau_J)) / kFciStepS));
  state_.tau_J = ToArray(tau_J);
  FeelForces(q_before, dq_before);
}

// External torques tau_ext, defined by M ddq + C dq = tau + tau_ext. The physics steps by semi-implicit
// Euler, so this holds with M and C of the step's beginning.
void FciRobot::FeelForces(const Joints& q_before, const Joints& dq_before) {
  const Joints ddq = (Joints(world_.ReadingSpeed()) - dq_before) / kFciStepS;
  const Joints tau_ext = chain_.MassMatrix(q_before) * ddq + chain_.CoriolisTorque(q_before, dq_before) -
                         tau_ - Joints(world_.DriveError());
  const double w = 2.0 * std::numbers::pi * kForceFilterHz * kFciStepS;
  tau_ext_ += w / (1.0 + w) * (tau_ext - tau_ext_);
  state_.tau_ext_hat_filtered = ToArray(tau_ext_);

  // The wrench at K that explains these torques, by least squares.
  const Eigen::Isometry3d X_BK = X_BE_ * F_T_EE() * ToPose(settings_.EE_T_K.pose);
  Eigen::Matrix<double, 6, 7> J = J_;
  for (int i = 0; i < franka::kJoints; ++i) {
    J.col(i).head<3>() += J.col(i).tail<3>().cross(X_BK.translation() - X_BE_.translation());
  }
  const Eigen::Matrix<double, 6, 6> JJt = J * J.transpose() + 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
  const Twist F = JJt.ldlt().solve(J * tau_ext_);
  Twist F_K;
  F_K << X_BK.linear().transpose() * F.head<3>(), X_BK.linear().transpose() * F.tail<3>();
  state_.O_F_ext_hat_K = ToArray(F);
  state_.K_F_ext_hat_K = ToArray(F_K);

  const franka::CollisionBehavior& c = settings_.collision;
  const bool accelerates = reference_.joints().ddq.cwiseAbs().maxCoeff() > kStill;
  Flag(state_.tau_ext_hat_filtered, accelerates ? c.lower_torque_acceleration : c.lower_torque_nominal,
       state_.joint_contact);
  Flag(state_.tau_ext_hat_filtered, accelerates ? c.upper_torque_acceleration : c.upper_torque_nominal,
       state_.joint_collision);
  Flag(state_.K_F_ext_hat_K, accelerates ? c.lower_force_acceleration : c.lower_force_nominal,
       state_.cartesian_contact);
  Flag(state_.K_F_ext_hat_K, accelerates ? c.upper_force_acceleration : c.upper_force_nominal,
       state_.cartesian_collision);
}

void FciRobot::Show() {
  franka::RobotState& s = state_;
  s.message_id = static_cast<std::uint64_t>(world_.now_ns() / hal::kNsPerMs);
  const Eigen::Isometry3d X_FEE = F_T_EE();
  const JointReference& r = reference_.joints();
  Jacobian J_d;
  const Eigen::Isometry3d X_d = chain_.TipPose(r.q, J_d);
  const Eigen::Vector3d arm = X_d.linear() * X_FEE.translation();
  Twist V_d = J_d * r.dq;
  V_d.head<3>() += V_d.tail<3>().cross(arm);

  s.O_T_EE = ToArray(Eigen::Isometry3d(X_BE_ * X_FEE));
  s.O_T_EE_d = ToArray(Eigen::Isometry3d(X_d * X_FEE));
  s.F_T_EE = ToArray(X_FEE);
  s.EE_T_K = settings_.EE_T_K.pose;
  s.F_T_NE = settings_.F_T_NE.pose;
  s.NE_T_EE = settings_.NE_T_EE.pose;
  s.m_load = settings_.load.mass;
  s.I_load = settings_.load.I_load;
  s.F_x_Cload = settings_.load.F_x_Cload;
  const auto sign = [](double angle) { return angle < 0.0 ? -1.0 : 1.0; };
  s.elbow = {measured_.q[2], sign(measured_.q[3])};
  s.elbow_d = {r.q[2], sign(r.q[3])};
  s.tau_J_d = ToArray(tau_);
  s.q = ToArray(measured_.q);
  s.dq = ToArray(measured_.dq);
  s.q_d = ToArray(r.q);
  s.dq_d = ToArray(r.dq);
  s.ddq_d = ToArray(r.ddq);
  s.theta = s.q;  // the simulated joints are stiff
  s.dtheta = s.dq;
  s.O_dP_EE_d = ToArray(V_d);

  const bool cartesian = s.motion_generator_mode >= franka::MotionGeneratorMode::kCartesianPosition;
  const CartesianReference& c = reference_.cartesian();
  s.O_T_EE_c = cartesian ? ToArray(c.X) : s.O_T_EE_d;
  s.O_dP_EE_c = cartesian ? ToArray(c.V) : s.O_dP_EE_d;
  s.O_ddP_EE_c = cartesian ? ToArray(c.A) : franka::Vector6{};
  s.elbow_c = cartesian ? franka::Vector2{c.elbow[0], c.elbow_sign} : s.elbow_d;
  s.delbow_c = {cartesian ? c.elbow[1] : r.dq[2], 0.0};
  s.ddelbow_c = {cartesian ? c.elbow[2] : r.ddq[2], 0.0};
}

}  // namespace fovea::sim
