// SPDX-License-Identifier: Apache-2.0
// A stiff spring and damper, constant over a whole millisecond, would make a light wrist overshoot. Both are
// therefore evaluated at the end of the step (backward Euler). The acceleration x beyond that of the
// reference solves  (M + D dt + K dt^2) x = K (e + e' dt) + D e'.
#include "sim/panda/controller.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fovea::sim {
namespace {

constexpr double kDampingRatio = 1.0;
constexpr double kPostureStiffness = 10.0;  // in the null space of a Cartesian impedance [Nm/rad]

// Stiffness of a guided hand along its locked axes.
constexpr double kLockedTranslation = 3000.0;  // [N/m]
constexpr double kLockedRotation = 300.0;      // [Nm/rad]
// Damping along its free axes.
constexpr double kFreeTranslation = 20.0;  // [N s/m]
constexpr double kFreeRotation = 1.0;      // [Nm s/rad]
constexpr double kFreePosture = 0.25;      // a free posture is damped as for this stiffness [Nm/rad]

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix67 = Eigen::Matrix<double, 6, 7>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

// The torque for the joints' stiffness `K` and damping `D`, with `pull` = K (e + e' dt) + D e'.
Joints AtEndOfStep(const FciMeasured& arm, const JointReference& reference, const Matrix7& K,
                   const Matrix7& D, const Joints& pull) {
  const Matrix7 A = arm.M + D * kFciStepS + K * (kFciStepS * kFciStepS);
  return arm.M * (reference.ddq + A.ldlt().solve(pull)) + arm.Cdq;
}

// The flange's Jacobian for a point at `arm` [m, in B] from the flange.
Matrix67 MovedTo(const Jacobian& J, const Eigen::Vector3d& arm) {
  Matrix67 moved = J;
  for (int i = 0; i < 7; ++i) {
    moved.col(i).head<3>() += moved.col(i).tail<3>().cross(arm);
  }
  return moved;
}

// Springs and dampers at a frame K, along and about its axes.
struct Spring {
  Twist K;                        // [N/m, Nm/rad]
  Twist D_least = Twist::Zero();  // minimum damping [N s/m, Nm s/rad]
  double posture = 0.0;           // stiffness of the posture in the null space [Nm/rad]
};

// Torque of `spring` between K, at F_T_K on the flange, and the reference pose of K.
Joints SpringTorque(const Chain& chain, const FciMeasured& arm, const JointReference& reference,
                    const Eigen::Isometry3d& F_T_K, const Spring& spring) {
  Jacobian J_E;
  const Eigen::Isometry3d X_BE = chain.TipPose(arm.q, J_E);
  const Eigen::Isometry3d X_K = X_BE * F_T_K;
  const Matrix67 J = MovedTo(J_E, X_K.translation() - X_BE.translation());
  Jacobian J_Ed;
  const Eigen::Isometry3d X_BEd = chain.TipPose(reference.q, J_Ed);
  const Eigen::Isometry3d X_Kd = X_BEd * F_T_K;
  const Matrix67 J_d = MovedTo(J_Ed, X_Kd.translation() - X_BEd.translation());

  // Rotates to the axes of K: the stiffness is given in them.
  Matrix6 to_K = Matrix6::Zero();
  to_K.topLeftCorner<3, 3>() = X_K.linear().transpose();
  to_K.bottomRightCorner<3, 3>() = X_K.linear().transpose();
  const Eigen::AngleAxisd turn(X_Kd.linear() * X_K.linear().transpose());
  Twist error;
  error << X_Kd.translation() - X_K.translation(), turn.angle() * turn.axis();
  const Twist rate = J_d * reference.dq - J * arm.dq;
  const Matrix67 J_K = to_K * J;
  const Matrix7 M_inverse = arm.M.inverse();
  const Matrix6 mobility =
      J_K * M_inverse * J_K.transpose() + 1e-6 * Matrix6::Identity();  // bounded when singular
  const Matrix6 inertia = mobility.inverse();
  const Twist& K = spring.K;
  const Twist D =
      (2.0 * kDampingRatio * K.cwiseProduct(Twist(inertia.diagonal())).cwiseSqrt()).cwiseMax(spring.D_least);
  const Twist wrench = K.cwiseProduct(to_K * (error + rate * kFciStepS)) + D.cwiseProduct(to_K * rate);

  // Null space: torques that do not accelerate K (Khatib 1987).
  const double as_stiff = std::max(spring.posture, kFreePosture);
  const Joints posture_damping = 2.0 * std::sqrt(as_stiff) * arm.M.diagonal().cwiseSqrt();
  const Joints posture =
      spring.posture * (reference.q - arm.q) + posture_damping.cwiseProduct(reference.dq - arm.dq);
  const Matrix7 free = Matrix7::Identity() - J_K.transpose() * inertia * J_K * M_inverse;
  return AtEndOfStep(arm, reference, J_K.transpose() * K.asDiagonal() * J_K,
                     J_K.transpose() * D.asDiagonal() * J_K, J_K.transpose() * wrench + free * posture);
}

}  // namespace

Joints JointImpedanceTorque(const FciMeasured& arm, const JointReference& reference,
                            const franka::JointImpedance& stiffness) {
  const Joints K = ToVector(stiffness.K_theta);
  const Joints D = 2.0 * kDampingRatio * K.cwiseProduct(Joints(arm.M.diagonal())).cwiseSqrt();
  const Joints rate = reference.dq - arm.dq;
  const Joints pull = K.cwiseProduct(reference.q - arm.q + rate * kFciStepS) + D.cwiseProduct(rate);
  return AtEndOfStep(arm, reference, K.asDiagonal(), D.asDiagonal(), pull);
}

Joints CartesianImpedanceTorque(const Chain& chain, const FciMeasured& arm, const JointReference& reference,
                                const Eigen::Isometry3d& F_T_K, const franka::CartesianImpedance& stiffness) {
  return SpringTorque(chain, arm, reference, F_T_K,
                      {ToVector(stiffness.K_x), Twist::Zero(), kPostureStiffness});
}

Joints GuidingTorque(const Chain& chain, const FciMeasured& arm, const Joints& begin,
                     const Eigen::Isometry3d& F_T_EE, const franka::GuidingMode& mode) {
  Spring spring;
  spring.posture = mode.nullspace != 0 ? 0.0 : kPostureStiffness;
  for (std::size_t i = 0; i < mode.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const bool translation = i < 3;
    const double locked = translation ? kLockedTranslation : kLockedRotation;
    spring.K[k] = mode.axes[i] != 0 ? 0.0 : locked;
    spring.D_least[k] = translation ? kFreeTranslation : kFreeRotation;
  }
  Eigen::Isometry3d F_T_K = F_T_EE;  // with axes parallel to O
  F_T_K.linear() = chain.TipPose(arm.q).linear().transpose();
  return SpringTorque(chain, arm, {begin, Joints::Zero(), Joints::Zero()}, F_T_K, spring);
}

}  // namespace fovea::sim
