// SPDX-License-Identifier: Apache-2.0
// Vectors and matrices of the firmware: fixed capacity, no heap.
#pragma once

#include <Eigen/Core>

#include "fovea/hal/types.hpp"

namespace fovea::model {

inline constexpr int kMaxJoints = hal::kMaxJoints;

using Vec3 = Eigen::Matrix<double, 3, 1>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat3 = Eigen::Matrix<double, 3, 3>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// One entry per joint: the size is set at run time, the storage is fixed.
using VecN = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
using MatN = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;
using Mat6N = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJoints>;

// a x b, and the matrix [a]x of that product. (Eigen's own needs its whole geometry module.)
inline Vec3 Cross(const Vec3& a, const Vec3& b) noexcept {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}
inline Mat3 CrossMatrix(const Vec3& a) noexcept {
  Mat3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

// Pose of frame B in frame A: p_A = R p_B + p.
struct Pose {
  Mat3 R = Mat3::Identity();
  Vec3 p = Vec3::Zero();

  // X_AC = X_AB * X_BC
  [[nodiscard]] Pose operator*(const Pose& X_BC) const noexcept { return {R * X_BC.R, R * X_BC.p + p}; }
  [[nodiscard]] Vec3 operator*(const Vec3& p_B) const noexcept { return R * p_B + p; }
  [[nodiscard]] Pose Inverse() const noexcept { return {R.transpose(), -(R.transpose() * p)}; }
};

// The joints' array at the seam as a vector of the model, and back (entries past the last joint are zero).
inline VecN ToVector(const hal::JointArray& values, int num_joints) noexcept {
  return Eigen::Map<const VecN>(values.data(), num_joints);
}
inline hal::JointArray ToArray(const VecN& values) noexcept {
  hal::JointArray array{};
  for (int i = 0; i < values.size(); ++i) {
    array[static_cast<std::size_t>(i)] = values[i];
  }
  return array;
}

}  // namespace fovea::model
