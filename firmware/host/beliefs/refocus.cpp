// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/refocus.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "firmware/core/features/sphere.hpp"

namespace fovea::beliefs {

using model::Mat3;
using model::Vec3;

bool RefocusSphere(const Vec3& s_meas, double focal, Vec3& s, Vec3& ds_dfocal) {
  constexpr int kRays = 16;
  const double distance = s_meas.norm();
  if (!(distance > features::SphereFeature::kMinDistance) || !(focal > -1.0)) {
    return false;
  }
  const Vec3 axis = s_meas / distance;
  const Vec3 across = axis.unitOrthogonal();
  const Vec3 up = axis.cross(across);
  const double sine = 1.0 / distance;
  const double cosine = std::sqrt(1.0 - sine * sine);
  // The rays x of the outline fulfil x . m = |x|.
  Mat3 A = Mat3::Zero();
  Mat3 dA = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  Vec3 db = Vec3::Zero();
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kRays;
    const Vec3 ray = cosine * axis + sine * (std::cos(angle) * across + std::sin(angle) * up);
    if (!(ray.z() > 0.0)) {
      return false;
    }
    const double shrink = 1.0 / (1.0 + focal);
    const Vec3 x(shrink * ray.x() / ray.z(), shrink * ray.y() / ray.z(), 1.0);
    const Vec3 dx(-shrink * x.x(), -shrink * x.y(), 0.0);
    const double length = x.norm();
    A += x * x.transpose();
    dA += dx * x.transpose() + x * dx.transpose();
    b += x * length;
    db += dx * length + x * (x.dot(dx) / length);
  }
  const auto factors = A.ldlt();
  const Vec3 m = factors.solve(b);
  Mat3 ds_dm;
  if (!features::SphereFromCone(m, s, ds_dm)) {
    return false;
  }
  ds_dfocal = ds_dm * factors.solve(db - dA * m);
  return true;
}

}  // namespace fovea::beliefs
