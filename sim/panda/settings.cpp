// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/settings.hpp"

#include <algorithm>

#include "sim/panda/types.hpp"

namespace fovea::sim {
namespace {

using franka::Command;
using franka::SetterStatus;

constexpr double kRigid = 1e-5;  // tolerance for a rigid pose and a symmetric inertia
// Above this stiffness, the discrete controller of a light wrist is unstable.
constexpr double kMaxJointStiffness = 14250.0;  // [Nm/rad]
constexpr double kMinTranslational = 10.0;      // [N/m]
constexpr double kMaxTranslational = 3000.0;
constexpr double kMinRotational = 1.0;  // [Nm/rad]
constexpr double kMaxRotational = 300.0;
constexpr double kMaxFilterHz = 1000.0;

template <std::size_t n>
bool AllWithin(const std::array<double, n>& values, double min, double max) {
  return std::all_of(values.begin(), values.end(), [=](double v) { return v >= min && v <= max; });
}

template <typename Value, typename Valid>
SetterStatus Take(std::span<const std::byte> payload, Value& value, Valid&& valid) {
  Value next;
  if (!franka::Decode(payload, next) || !valid(next)) {
    return SetterStatus::kInvalidArgument;
  }
  value = next;
  return SetterStatus::kSuccess;
}

bool Valid(const franka::CollisionBehavior& c) {
  constexpr double kMost = 1e4;
  const auto positive = [](const auto& values) { return AllWithin(values, 0.0, kMost); };
  return positive(c.lower_torque_acceleration) && positive(c.upper_torque_acceleration) &&
         positive(c.lower_torque_nominal) && positive(c.upper_torque_nominal) &&
         positive(c.lower_force_acceleration) && positive(c.upper_force_acceleration) &&
         positive(c.lower_force_nominal) && positive(c.upper_force_nominal);
}

bool Valid(const franka::Load& load) {
  const Eigen::Matrix3d I = Eigen::Map<const Eigen::Matrix3d>(load.I_load.data());
  constexpr double kMostMass = 20.0;
  return load.mass >= 0.0 && load.mass <= kMostMass && AllWithin(load.F_x_Cload, -2.0, 2.0) &&
         I.allFinite() && (I - I.transpose()).norm() < kRigid && I.diagonal().minCoeff() >= 0.0;
}

}  // namespace

bool IsPose(const franka::Matrix4& pose) {
  const Eigen::Matrix4d X = Eigen::Map<const Eigen::Matrix4d>(pose.data());
  if (!X.allFinite()) {
    return false;
  }
  const Eigen::Matrix3d R = X.topLeftCorner<3, 3>();
  return (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kRigid && R.determinant() > 0.0 &&
         (X.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kRigid;
}

SetterStatus ApplySetter(Command command, std::span<const std::byte> payload, FciSettings& s) {
  const auto pose = [](const franka::FramePose& f) { return IsPose(f.pose); };
  switch (command) {
    case Command::kSetCollisionBehavior:
      return Take(payload, s.collision, [](const auto& c) { return Valid(c); });
    case Command::kSetJointImpedance:
      return Take(payload, s.joint_impedance,
                  [](const auto& k) { return AllWithin(k.K_theta, 0.0, kMaxJointStiffness); });
    case Command::kSetCartesianImpedance:
      return Take(payload, s.cartesian_impedance, [](const franka::CartesianImpedance& k) {
        return std::all_of(k.K_x.begin(), k.K_x.begin() + 3,
                           [](double v) { return v >= kMinTranslational && v <= kMaxTranslational; }) &&
               std::all_of(k.K_x.begin() + 3, k.K_x.end(),
                           [](double v) { return v >= kMinRotational && v <= kMaxRotational; });
      });
    case Command::kSetGuidingMode: return Take(payload, s.guiding, [](const auto&) { return true; });
    case Command::kSetEEToK: return Take(payload, s.EE_T_K, pose);
    case Command::kSetNEToEE: return Take(payload, s.NE_T_EE, pose);
    case Command::kSetLoad: return Take(payload, s.load, [](const auto& load) { return Valid(load); });
    case Command::kSetFilters:
      return Take(payload, s.filters, [](const franka::Filters& f) {
        return AllWithin(std::array{f.joint_position, f.joint_velocity, f.cartesian_position,
                                    f.cartesian_velocity, f.controller},
                         1.0, kMaxFilterHz);
      });
    default: return SetterStatus::kInvalidArgument;
  }
}

}  // namespace fovea::sim
