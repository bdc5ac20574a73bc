// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/curve.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace fovea::vision {

Eigen::Matrix3d ConeCurve::Conic(const Intrinsics& in) const {
  Eigen::Matrix3d T;  // ray of a pixel
  T << 1.0 / in.f_u_px, 0.0, -in.c_u_px / in.f_u_px, 0.0, 1.0 / in.f_v_px, -in.c_v_px / in.f_v_px, 0.0, 0.0,
      1.0;
  return T.transpose() * (Eigen::Matrix3d::Identity() - p * p.transpose()) * T;
}

Eigen::Matrix3d EllipseCurve::Conic(const Intrinsics& /*in*/) const {
  Eigen::Matrix3d local;
  local << p[0], 0.5 * p[1], 0.5 * p[3], 0.5 * p[1], p[2], 0.5 * p[4], 0.5 * p[3], 0.5 * p[4], -1.0;
  Eigen::Matrix3d T;
  T << 1.0 / size_px, 0.0, -u0_px / size_px, 0.0, 1.0 / size_px, -v0_px / size_px, 0.0, 0.0, 1.0;
  return T.transpose() * local * T;
}

EllipseCurve EllipseCurve::Next(const EllipseCurve& before) const {
  // An ellipse's conic in pixels depends neither on the intrinsics nor on its own frame (u0, v0, size).
  const Intrinsics none;
  const Ellipse now = EllipseOf(Conic(none));
  const Ellipse then = EllipseOf(before.Conic(none));
  EllipseCurve next = *this;
  next.size_px *= now.radius_px / then.radius_px;
  const double growth = next.size_px / size_px;
  // Extrapolate the curve's centre, not its frame's origin.
  next.u0_px = 2.0 * now.u_px - then.u_px + growth * (u0_px - now.u_px);
  next.v0_px = 2.0 * now.v_px - then.v_px + growth * (v0_px - now.v_px);
  return next;
}

Ellipse EllipseOf(const Eigen::Matrix3d& Q) {
  Ellipse e;
  const double det = Q(0, 0) * Q(1, 1) - Q(0, 1) * Q(0, 1);
  if (!(det > 0.0) || !(Q(0, 0) > 0.0)) {
    return e;
  }
  e.u_px = (Q(0, 1) * Q(1, 2) - Q(1, 1) * Q(0, 2)) / det;
  e.v_px = (Q(0, 1) * Q(0, 2) - Q(0, 0) * Q(1, 2)) / det;
  const double depth = -(Q(2, 2) + Q(0, 2) * e.u_px + Q(1, 2) * e.v_px);  // -F at the middle
  if (!(depth > 0.0)) {
    return e;
  }
  const double mean = 0.5 * (Q(0, 0) + Q(1, 1));
  const double half = std::hypot(0.5 * (Q(0, 0) - Q(1, 1)), Q(0, 1));
  e.major_px = std::sqrt(depth / (mean - half));
  e.minor_px = std::sqrt(depth / (mean + half));
  e.radius_px = std::sqrt(e.major_px * e.minor_px);
  e.real = std::isfinite(e.major_px) && std::isfinite(e.u_px) && std::isfinite(e.v_px);
  return e;
}

void EllipsePoints(const Eigen::Matrix3d& Q, std::span<Eigen::Vector2d> points) {
  const Ellipse e = EllipseOf(Q);
  const double depth = -(Q(2, 2) + Q(0, 2) * e.u_px + Q(1, 2) * e.v_px);
  const double angle = 2.0 * std::numbers::pi / static_cast<double>(points.size());
  const double turn_c = std::cos(angle);
  const double turn_s = std::sin(angle);
  double c = 1.0;
  double s = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = std::sqrt(depth / (Q(0, 0) * c * c + 2.0 * Q(0, 1) * c * s + Q(1, 1) * s * s));
    points[i] = {e.u_px + r * c, e.v_px + r * s};
    // Rotate (c, s) to the next angle, which is faster than cos and sin.
    const double next = turn_c * c - turn_s * s;
    s = turn_s * c + turn_c * s;
    c = next;
  }
}

}  // namespace fovea::vision
