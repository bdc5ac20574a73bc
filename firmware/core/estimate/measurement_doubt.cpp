// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/measurement_doubt.hpp"

#include "firmware/core/model/rotation.hpp"
#include "firmware/core/model/twist.hpp"

namespace fovea::estimate {
namespace {

constexpr std::int64_t kMomentNs = 200 * hal::kNsPerMs;  // in which the filter absorbs an error
constexpr std::int64_t kStepNs = 20 * hal::kNsPerMs;     // interval of a velocity's difference

// The camera's mean twist in its own axes between `X_BC_before` and `X_BC`.
model::Vec6 TwistBetween(const model::Pose& X_BC_before, const model::Pose& X_BC) noexcept {
  constexpr double kStepS = 1e-9 * static_cast<double>(kStepNs);
  model::Vec6 V_BC_C;
  V_BC_C.head<3>() = X_BC.R.transpose() * (X_BC.p - X_BC_before.p) / kStepS;
  V_BC_C.tail<3>() = model::RotationVector(X_BC_before.R.transpose() * X_BC.R) / kStepS;
  return V_BC_C;
}

}  // namespace

model::Mat6 MeasurementDoubt(const config::ServoConfig& config, const JointHistory& history,
                             std::int64_t stamp_ns, const model::Pose& X_BC) noexcept {
  const config::PredictConfig& c = config.predict;
  const auto at = [&](std::int64_t time_ns, model::Pose& X) {
    return CameraPoseAt(history, config.arm, config.X_EC, time_ns, X);
  };
  model::Pose X_BC_step;
  model::Pose X_BC1;
  model::Pose X_BC1_step;
  if (!at(stamp_ns - kStepNs, X_BC_step) || !at(stamp_ns - kMomentNs, X_BC1) ||
      !at(stamp_ns - kMomentNs - kStepNs, X_BC1_step)) {
    return model::Mat6::Zero();
  }
  const model::Pose X_C2C1 = X_BC.Inverse() * X_BC1;
  // I - Ad(X_C2C1), column by column, each scaled by its error.
  model::Mat6 doubt;
  for (int i = 0; i < 6; ++i) {
    const model::Vec6 error = model::Vec6::Unit(i) * (i < 3 ? c.mount_shift_sigma : c.mount_turn_sigma);
    doubt.col(i) = error - model::ShiftTwist(X_C2C1, error);
  }
  model::Mat6 cov = doubt.lazyProduct(doubt.transpose());
  const model::Vec6 by_stamp = c.stamp_sigma * (TwistBetween(X_BC_step, X_BC) -
                                                model::ShiftTwist(X_C2C1, TwistBetween(X_BC1_step, X_BC1)));
  cov += by_stamp.lazyProduct(by_stamp.transpose());
  // For a target at rest, c - R_C2C1 c_1 is the camera's displacement in its own axes.
  const model::Vec3 by_scale = c.scale_sigma * (X_BC.R.transpose() * (X_BC1.p - X_BC.p));
  cov.topLeftCorner<3, 3>() += by_scale.lazyProduct(by_scale.transpose());
  return cov;
}

}  // namespace fovea::estimate
