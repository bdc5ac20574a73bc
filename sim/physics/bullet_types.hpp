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

inline Eigen::Isometry3d ToEigen(const btTransform& t) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  const btQuaternion q = t.getRotation();
  X.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).toRotationMatrix();
  X.translation() = Eigen::Vector3d(t.getOrigin().x(), t.getOrigin().y(), t.getOrigin().z());
  return X;
}

}  // namespace fovea::sim
