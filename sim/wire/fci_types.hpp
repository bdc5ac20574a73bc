// The interface's plain arrays as matrices, and back; and the limits that it enforces (Panda).
#pragma once

#include <Eigen/Geometry>

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
  return Eigen::Isometry3d(Eigen::Map<const Eigen::Matrix4d>(values.data()));  // column-major, both
}
inline franka::Matrix4 ToArray(const Eigen::Isometry3d& pose) {
  franka::Matrix4 values;
  Eigen::Map<Eigen::Matrix4d>(values.data()) = pose.matrix();
  return values;
}

inline constexpr double kFciStepS = 1e-3;

// Position, velocity, acceleration and jerk of something, and how large they may be.
struct RateLimits {
  double velocity;
  double acceleration;
  double jerk;
};

namespace fci_limits {

inline const Joints kQMin =
    (Joints() << -2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973).finished();
inline const Joints kQMax = (Joints() << 2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973).finished();
inline const Joints kDq = (Joints() << 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61).finished();
inline const Joints kDdq = (Joints() << 15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0).finished();
inline const Joints kDddq = (Joints() << 7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0).finished();
inline const Joints kTau = (Joints() << 87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0).finished();
inline constexpr double kTorqueStep = 1.0;  // 1000 Nm/s, from one state to the next
inline constexpr RateLimits kTranslation{1.7, 13.0, 6500.0};
inline constexpr RateLimits kRotation{2.5, 25.0, 12500.0};
inline constexpr RateLimits kElbow{2.175, 10.0, 5000.0};
inline constexpr double kBeyond =
    2e-3;  // a measured joint may be this far outside, on its way along a limit [rad]
inline constexpr int kMissingToStop = 20;
// Rounding in a command's third difference over 1 ms, and in ours.
inline constexpr double kRounding = 1.001;

}  // namespace fci_limits

}  // namespace fovea::sim
