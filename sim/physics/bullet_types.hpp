// SPDX-License-Identifier: Apache-2.0
// Our types and Bullet's, one from the other.
#pragma once

#include <LinearMath/btTransform.h>

#include <Eigen/Geometry>

namespace fovea::sim {

inline constexpr double kGravity = 9.81;  // [m/s^2]

inline btVector3 ToBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline btQuaternion ToBullet(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {q.x(), q.y(), q.z(), q.w()};
}
inline btTransform ToBullet(const Eigen::Isometry3d& X) {
  return btTransform(ToBullet(Eigen::Matrix3d(X.linear())), ToBullet(Eigen::Vector3d(X.translation())));
}

}  // namespace fovea::sim
