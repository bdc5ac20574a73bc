// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/rotation.hpp"

#include <cmath>

#include "firmware/core/model/math.hpp"

namespace fovea::model {
namespace {

constexpr double kSmall = 1e-4;  // below it the series' first terms are exact to the last digits [rad]

// sin(a) / a, (1 - cos(a)) / a^2 and (1 - sin(a) / a) / a^2 for the angle a.
struct Coefficients {
  double sine;
  double versine;
  double rest;
};

Coefficients CoefficientsOf(double angle) noexcept {
  const double a2 = angle * angle;
  if (angle < kSmall) {
    return {1.0 - a2 / 6.0, 0.5 - a2 / 24.0, 1.0 / 6.0 - a2 / 120.0};
  }
  const SinCosResult half = SinCos(0.5 * angle);
  const double sine = 2.0 * half.sin * half.cos / angle;
  return {sine, 2.0 * half.sin * half.sin / a2, (1.0 - sine) / a2};
}

// The quaternion w, v of a turn, of any length, w >= 0. By its largest entry: 4 w^2 = 1 + trace,
// 4 x^2 = 1 + R00 - R11 - R22, ...
struct UnscaledQuaternion {
  double w = 0.0;
  Vec3 v = Vec3::Zero();
};

UnscaledQuaternion UnscaledQuaternionOf(const Mat3& R) noexcept {
  UnscaledQuaternion q;
  const double trace = R.trace();
  int largest = -1;  // the entry w
  double most = trace;
  for (int i = 0; i < 3; ++i) {
    if (R(i, i) > most) {
      most = R(i, i);
      largest = i;
    }
  }
  if (largest < 0) {
    q.w = 1.0 + trace;
    q.v = {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  } else {
    const int i = largest;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    q.w = R(k, j) - R(j, k);
    q.v[i] = 1.0 + R(i, i) - R(j, j) - R(k, k);
    q.v[j] = R(j, i) + R(i, j);
    q.v[k] = R(k, i) + R(i, k);
  }
  if (q.w < 0.0) {
    q.w = -q.w;
    q.v = -q.v;
  }
  return q;
}

}  // namespace

Mat3 RotationOf(const Vec3& phi) noexcept {
  const Coefficients c = CoefficientsOf(phi.norm());
  const Mat3 X = CrossMatrix(phi);
  return Mat3::Identity() + c.sine * X + c.versine * X.lazyProduct(X);
}

bool RotationOfQuaternion(const std::array<double, 4>& quaternion, Mat3& R) noexcept {
  double norm2 = 0.0;
  for (const double entry : quaternion) {
    norm2 += entry * entry;
  }
  if (!(norm2 > 1e-12 && norm2 < 1e12)) {
    return false;
  }
  const double scale = 1.0 / std::sqrt(norm2);
  const double w = quaternion[0] * scale;
  const double x = quaternion[1] * scale;
  const double y = quaternion[2] * scale;
  const double z = quaternion[3] * scale;
  R << 2.0 * (w * w + x * x) - 1.0, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),  //
      2.0 * (x * y + w * z), 2.0 * (w * w + y * y) - 1.0, 2.0 * (y * z - w * x),   //
      2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 2.0 * (w * w + z * z) - 1.0;
  return true;
}

Vec3 RotationVector(const Mat3& R) noexcept {
  const UnscaledQuaternion q = UnscaledQuaternionOf(R);
  const double n = q.v.norm();
  if (n < 1e-300) {
    return Vec3::Zero();
  }
  return q.v * (2.0 * Atan2(n, q.w) / n);
}

std::array<double, 4> QuaternionOf(const Mat3& R) noexcept {
  const UnscaledQuaternion q = UnscaledQuaternionOf(R);
  const double scale = 1.0 / std::sqrt(q.w * q.w + q.v.squaredNorm());
  return {scale * q.w, scale * q.v[0], scale * q.v[1], scale * q.v[2]};
}

Mat3 TurnRateMatrix(const Vec3& phi) noexcept {
  const Coefficients c = CoefficientsOf(phi.norm());
  const Mat3 X = CrossMatrix(phi);
  return Mat3::Identity() + c.versine * X + c.rest * X.lazyProduct(X);
}

Mat3 TurnRateInverse(const Vec3& phi) noexcept {
  const double angle = phi.norm();
  const Mat3 X = CrossMatrix(phi);
  double c = 1.0 / 12.0 + angle * angle / 720.0;
  if (angle >= kSmall) {
    const Coefficients k = CoefficientsOf(angle);
    c = (1.0 - 0.5 * k.sine / k.versine) / (angle * angle);
  }
  return Mat3::Identity() - 0.5 * X + c * X.lazyProduct(X);
}

}  // namespace fovea::model
