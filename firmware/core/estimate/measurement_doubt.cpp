// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/measurement_doubt.hpp"

#include "firmware/core/model/twist.hpp"

namespace fovea::estimate {
namespace {

constexpr std::int64_t kMomentNs = 200 * hal::kNsPerMs;  // in which the filter absorbs an error

// What a focal length that is wrong by its whole size does to a target at `c`, to first order: shift [m] and
// turn [rad] in axes of C.
model::Vec6 ByFocalLength(const model::Vec3& c) noexcept {
  model::Vec6 error;
  error << 0.0, 0.0, -c.z(), model::Vec3(-c.y(), c.x(), 0.0) * (c.z() / c.squaredNorm());
  return error;
}

}  // namespace

const model::Mat6& MeasurementDoubt::OfCamera() noexcept {
  if (!cov_) {
    cov_ = Compute();
  }
  return *cov_;
}

model::Mat3 MeasurementDoubt::OfPlace(const model::Vec3& p_CO_C) noexcept {
  const PlaceSlope by_camera = PlaceByCamera(p_CO_C);
  const model::Mat3 doubt_C = by_camera * OfCamera() * by_camera.transpose();
  return X_BC_.R * doubt_C * X_BC_.R.transpose();
}

PlaceSlope PlaceByCamera(const model::Vec3& p_CO_C) noexcept {
  PlaceSlope by_camera;
  by_camera << model::Mat3::Identity(), -model::CrossMatrix(p_CO_C);
  return by_camera;
}

model::Mat6 MeasurementDoubt::Compute() const noexcept {
  const config::PredictConfig& c = config_.predict;
  model::Pose X_BC1;
  if (!CameraPoseAt(history_, config_.arm, config_.X_EC, stamp_ns_ - kMomentNs, X_BC1)) {
    return model::Mat6::Zero();
  }
  const model::Pose X_C2C1 = X_BC_.Inverse() * X_BC1;
  // I - Ad(X_C2C1), column by column, each scaled by its error.
  model::Mat6 doubt;
  for (int i = 0; i < 6; ++i) {
    const model::Vec6 error = model::Vec6::Unit(i) * (i < 3 ? c.mount_shift_sigma : c.mount_turn_sigma);
    doubt.col(i) = error - model::ShiftTwist(X_C2C1, error);
  }
  model::Mat6 cov = doubt.lazyProduct(doubt.transpose());
  // For a target at rest, c - R_C2C1 c_1 is the camera's displacement in its own axes.
  const model::Vec3 by_scale = c.scale_sigma * (X_BC_.R.transpose() * (X_BC1.p - X_BC_.p));
  cov.topLeftCorner<3, 3>() += by_scale.lazyProduct(by_scale.transpose());
  const model::Vec6 before = ByFocalLength(X_C2C1.Inverse() * p_CO_C_);
  const model::Vec6 now = ByFocalLength(p_CO_C_);
  // The twist of the camera that would move the target in the same way: -v - w x c is the shift, -w the turn.
  const model::Vec3 w = X_C2C1.R * before.tail<3>() - now.tail<3>();
  model::Vec6 by_focal;
  by_focal << X_C2C1.R * before.head<3>() - now.head<3>() - model::Cross(w, p_CO_C_), w;
  by_focal *= c.scale_sigma;
  cov += by_focal.lazyProduct(by_focal.transpose());
  return cov;
}

}  // namespace fovea::estimate
