// SPDX-License-Identifier: Apache-2.0
// Converts the interface's arrays to matrices and back. Holds the Panda's limits that the interface enforces.
#pragma once

#include <Eigen/Geometry>

#include "fovea/franka/panda_limits.hpp"
#include "fovea/franka/states.hpp"

namespace fovea::sim {

using Joints = Eigen::Matrix<double, franka::kJoints, 1>;
using Twist = Eigen::Matrix<double, 6, 1>;  // [v; w]

template <std::size_t n>
Eigen::Matrix<double, static_cast<int>(n), 1> ToVector(const std::array<double, n>& values) {
  return Eigen::Map<const Eigen::Matrix<double, static_cast<int>(n), 1>>(values.data());
}
template <int n>
std::array<double, static_cast<std::size_t>(n)> ToArray(const Eigen::Matrix<double, n, 1>& vector) {
  std::array<double, static_cast<std::size_t>(n)> values;
  Eigen::Map<Eigen::Matrix<double, n, 1>>(values.data()) = vector;
  return values;
}
inline Eigen::Isometry3d ToPose(const franka::Matrix4& values) {
  return Eigen::Isometry3d(Eigen::Map<const Eigen::Matrix4d>(values.data()));  // both are column-major
}
inline franka::Matrix4 ToArray(const Eigen::Isometry3d& pose) {
  franka::Matrix4 values;
  Eigen::Map<Eigen::Matrix4d>(values.data()) = pose.matrix();
  return values;
}

inline constexpr double kFciStepS = 1e-3;

// Largest velocity, acceleration and jerk.
struct RateLimits {
  double velocity;
  double acceleration;
  double jerk;
};

namespace fci_limits {

// Collects one limit of all joints.
template <double franka::PandaJoint::*kMember>
Joints OfEachJoint() {
  Joints values;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = franka::kPandaJoints[static_cast<std::size_t>(i)].*kMember;
  }
  return values;
}

inline const Joints kQMin = OfEachJoint<&franka::PandaJoint::q_min>();
inline const Joints kQMax = OfEachJoint<&franka::PandaJoint::q_max>();
inline const Joints kDq = OfEachJoint<&franka::PandaJoint::dq_max>();
inline const Joints kDdq = OfEachJoint<&franka::PandaJoint::ddq_max>();
inline const Joints kDddq = OfEachJoint<&franka::PandaJoint::dddq_max>();
inline const Joints kTau = OfEachJoint<&franka::PandaJoint::tau_max>();
inline constexpr double kTorqueStep =
    franka::kPandaTorqueRate * kFciStepS;  // from one state to the next [Nm]
inline constexpr RateLimits kTranslation{franka::kPandaHandSpeed, 13.0, 6500.0};
inline constexpr RateLimits kRotation{franka::kPandaHandRotation, 25.0, 12500.0};
inline constexpr RateLimits kElbow{2.175, 10.0, 5000.0};
inline constexpr double kBeyond =
    2e-3;  // tolerance of a measured joint outside its range, for motion along a limit [rad]
inline constexpr int kMissingToStop = 20;
// Tolerance for rounding in the client's and our own third differences over 1 ms.
inline constexpr double kRounding = 1.001;

}  // namespace fci_limits

}  // namespace fovea::sim
