// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/rolling_shutter.hpp"

#include <Eigen/LU>  // inverse of a 3x3
#include <cmath>
#include <numbers>

#include "firmware/core/model/math.hpp"

namespace fovea::estimate {
namespace {

using model::Mat3;
using model::Vec3;

constexpr int kOutlinePoints = 16;

// How long after the stamp the row `y` of the normalised image is exposed [s].
double Delta(const config::PredictConfig& config, double y) noexcept {
  return config.row_time * (y - config.row_y);
}

}  // namespace

MotionInCamera SeenFrom(const model::Pose& X_BC, const model::Vec6& V_BC_C, const model::Pose& X_CO,
                        const Vec3& v_BO_B, const Vec3& w_BO_B) noexcept {
  const Vec3 w_BC_C = V_BC_C.tail<3>();
  return {X_CO, X_BC.R.transpose() * v_BO_B - V_BC_C.head<3>() - model::CrossMatrix(w_BC_C) * X_CO.p,
          X_BC.R.transpose() * w_BO_B - w_BC_C};
}

// The outline is F(d) = R^2 |d|^2 - |d x p|^2 = 0 for rays d = (x, y, 1). A displacement q of the centre
// moves it along its normal by g q, with g = dF/dp over the length of dF/d(x, y). The outline's point k moves
// as if the centre had moved by v delta_k. The fit minimises the sum of (g_k q - g_k v delta_k)^2.
Mat3 SphereShiftByVelocity(const config::PredictConfig& config, double radius, const Vec3& p) noexcept {
  const double distance = p.norm();
  if (!(distance > radius) || !(p.z() > radius)) {
    return Mat3::Zero();
  }
  const Vec3 axis = p / distance;
  const Vec3 across = (model::CrossMatrix(axis) * Vec3::UnitY()).normalized();
  const Vec3 down = model::CrossMatrix(axis) * across;
  const double sine = radius / distance;
  const double cosine = std::sqrt(1.0 - sine * sine);
  Mat3 M = Mat3::Zero();
  Mat3 M_delta = Mat3::Zero();
  for (int k = 0; k < kOutlinePoints; ++k) {
    const model::SinCosResult angle = model::SinCos(2.0 * std::numbers::pi * k / kOutlinePoints);
    const Vec3 ray = cosine * axis + sine * (angle.cos * across + angle.sin * down);
    const Vec3 d = ray / ray.z();
    const Vec3 by_centre = d.squaredNorm() * p - d.dot(p) * d;
    const Vec3 by_ray = (radius * radius - p.squaredNorm()) * d + d.dot(p) * p;
    const Vec3 g = by_centre / by_ray.head<2>().norm();
    M += g * g.transpose();
    M_delta += Delta(config, d.y()) * g * g.transpose();
  }
  return M.inverse() * M_delta;
}

Mat3 DiscShiftByVelocity(const config::PredictConfig& config, const Vec3& p) noexcept {
  const double delta = p.z() >= features::kMinDepth ? Delta(config, p.y() / p.z()) : 0.0;
  return delta * Mat3::Identity();
}

void MoveCornersToStamp(const config::PredictConfig& config, const MotionInCamera& target,
                        features::SeenCorners::Vector& xy) noexcept {
  const Vec3 normal = target.X_CO.R.col(2);
  for (Eigen::Index i = 0; i + 1 < xy.size(); i += 2) {
    const Vec3 ray(xy[i], xy[i + 1], 1.0);
    const double depth = normal.dot(target.X_CO.p) / normal.dot(ray);
    if (!(depth >= features::kMinDepth) || !std::isfinite(depth)) {
      continue;
    }
    const Vec3 v = target.v + model::CrossMatrix(target.w) * (depth * ray - target.X_CO.p);
    xy.segment<2>(i) -= Delta(config, ray.y()) * (v.head<2>() - v.z() * ray.head<2>()) / depth;
  }
}

}  // namespace fovea::estimate
