// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/twist.hpp"

#include <cmath>

#include "firmware/core/model/rotation.hpp"

namespace fovea::model {

Vec6 ShiftTwist(const Pose& X_AB, const Vec6& V_B) noexcept {
  const Vec3 w = X_AB.R.lazyProduct(V_B.tail<3>());
  Vec6 V_A;
  V_A.head<3>() = X_AB.R.lazyProduct(V_B.head<3>());
  V_A.head<3>() += Cross(X_AB.p, w);
  V_A.tail<3>() = w;
  return V_A;
}

bool CameraToBaseTwist(const std::array<double, 7>& x_BE, const Pose& X_EC, const Vec6& V_BC_C,
                       Vec6& V_BE_B) noexcept {
  Mat3 R_BE;
  const bool is_pose = std::isfinite(x_BE[0]) && std::isfinite(x_BE[1]) && std::isfinite(x_BE[2]) &&
                       RotationOfQuaternion({x_BE[3], x_BE[4], x_BE[5], x_BE[6]}, R_BE);
  const Vec6 V_BE_E = ShiftTwist(X_EC, V_BC_C);
  if (!is_pose || !V_BE_E.allFinite()) {
    return false;
  }
  V_BE_B.head<3>() = R_BE.lazyProduct(V_BE_E.head<3>());
  V_BE_B.tail<3>() = R_BE.lazyProduct(V_BE_E.tail<3>());
  return true;
}

}  // namespace fovea::model
