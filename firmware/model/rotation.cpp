#include "fovea/model/rotation.hpp"

#include <cmath>

#include "fovea/model/math.hpp"

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

}  // namespace

Mat3 RotationOf(const Vec3& phi) noexcept {
  const Coefficients c = CoefficientsOf(phi.norm());
  const Mat3 X = CrossMatrix(phi);
  return Mat3::Identity() + c.sine * X + c.versine * X.lazyProduct(X);
}

Vec3 RotationVector(const Mat3& R) noexcept {
  // The quaternion by its largest entry: 4 w^2 = 1 + trace, 4 x^2 = 1 + R00 - R11 - R22, ...
  const double trace = R.trace();
  double w = 0.0;
  Vec3 v = Vec3::Zero();
  int largest = -1;  // the entry w
  double most = trace;
  for (int i = 0; i < 3; ++i) {
    if (R(i, i) > most) {
      most = R(i, i);
      largest = i;
    }
  }
  if (largest < 0) {
    w = 1.0 + trace;
    v = {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  } else {
    const int i = largest;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    w = R(k, j) - R(j, k);
    v[i] = 1.0 + R(i, i) - R(j, j) - R(k, k);
    v[j] = R(j, i) + R(i, j);
    v[k] = R(k, i) + R(i, k);
  }
  if (w < 0.0) {
    w = -w;
    v = -v;
  }
  const double n = v.norm();
  if (n < 1e-300) {
    return Vec3::Zero();
  }
  return v * (2.0 * Atan2(n, w) / n);
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
