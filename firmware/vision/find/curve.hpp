// SPDX-License-Identifier: Apache-2.0
// Closed curves in the image that are linear in their parameters: F(u, v) = row(u, v) . p - rhs(u, v), zero
// on the curve, positive outside. So a fit is weighted least squares, the gradient gives distances, and
// sphere and disc share finder, edges and fit.
#pragma once

#include <Eigen/Core>
#include <span>

#include "firmware/vision/intrinsics.hpp"

namespace fovea::vision {

template <int N>
struct CurveRow {
  using Vector = Eigen::Matrix<double, N, 1>;
  Vector row, row_u, row_v;  // and its derivatives along u and v
  double rhs = 0.0;
  double rhs_u = 0.0;
  double rhs_v = 0.0;
};

// A sphere's outline: the cone |x| - x . m of tangent rays (features/sphere.hpp), p = m.
struct ConeCurve {
  static constexpr int kDim = 3;
  using Parameters = Eigen::Matrix<double, kDim, 1>;
  Parameters p = Parameters::Zero();

  // Sets the curve's own frame before a fit; a cone has none.
  void Frame(const Intrinsics& /*in*/, double /*u_px*/, double /*v_px*/, double /*size_px*/) {}
  [[nodiscard]] CurveRow<kDim> Row(const Intrinsics& in, double u_px, double v_px) const {
    const model::Vec3 x = in.Ray(u_px, v_px);
    const double norm = x.norm();
    CurveRow<kDim> r;
    r.row = -x;
    r.row_u = model::Vec3(-1.0 / in.f_u_px, 0.0, 0.0);
    r.row_v = model::Vec3(0.0, -1.0 / in.f_v_px, 0.0);
    r.rhs = -norm;
    r.rhs_u = -x.x() / (norm * in.f_u_px);
    r.rhs_v = -x.y() / (norm * in.f_v_px);
    return r;
  }
  // Q of (u, v, 1) Q (u, v, 1)' = 0, negative inside.
  [[nodiscard]] Eigen::Matrix3d Conic(const Intrinsics& in) const;
  // The curve in the next image, extrapolated linearly from `before` and this one.
  [[nodiscard]] ConeCurve Next(const ConeCurve& before) const {
    ConeCurve next;
    next.p = 2.0 * p - before.p;
    return next;
  }
};

// Any ellipse, for a disc's outline. p = coefficients of x^2, xy, y^2, x, y in F = p . (...) - 1, with x and
// y the pixel minus (`u0`, `v0`), in units of `size`; |(x, y)| is about 1 on the curve.
struct EllipseCurve {
  static constexpr int kDim = 5;
  using Parameters = Eigen::Matrix<double, kDim, 1>;
  Parameters p = Parameters::Zero();
  double u0_px = 0.0;
  double v0_px = 0.0;
  double size_px = 1.0;

  void Frame(const Intrinsics& /*in*/, double u_px, double v_px, double size) {
    u0_px = u_px;
    v0_px = v_px;
    size_px = size;
  }
  [[nodiscard]] CurveRow<kDim> Row(const Intrinsics& /*in*/, double u_px, double v_px) const {
    const double x = (u_px - u0_px) / size_px;
    const double y = (v_px - v0_px) / size_px;
    const double d = 1.0 / size_px;
    CurveRow<kDim> r;
    r.row << x * x, x * y, y * y, x, y;
    r.row_u << 2.0 * x * d, y * d, 0.0, d, 0.0;
    r.row_v << 0.0, x * d, 2.0 * y * d, 0.0, d;
    r.rhs = 1.0;
    return r;
  }
  [[nodiscard]] Eigen::Matrix3d Conic(const Intrinsics& in) const;
  // The same; centre and size are extrapolated, the shape stays.
  [[nodiscard]] EllipseCurve Next(const EllipseCurve& before) const;
};

// An ellipse by its centre and half axes.
struct Ellipse {
  bool real = false;  // false: the conic is not an ellipse
  double u_px = 0.0;
  double v_px = 0.0;
  double major_px = 0.0;  // half axes
  double minor_px = 0.0;
  double radius_px = 0.0;  // of the circle with the same area
};
Ellipse EllipseOf(const Eigen::Matrix3d& conic);

// Distance from the curve to first order, F / |grad F|, positive outside; sets the outward normal (nu, nv).
template <class Curve>
double DistanceTo(const Curve& curve, const Intrinsics& in, double u_px, double v_px, double& nu,
                  double& nv) {
  const CurveRow<Curve::kDim> r = curve.Row(in, u_px, v_px);
  const double fu = r.row_u.dot(curve.p) - r.rhs_u;
  const double fv = r.row_v.dot(curve.p) - r.rhs_v;
  const double length = std::sqrt(fu * fu + fv * fv);
  nu = fu / length;
  nv = fv / length;
  return (r.row.dot(curve.p) - r.rhs) / length;
}

// Distance along (du, dv) from (u, v) to the curve, by Newton's method from `start_px`.
template <class Curve>
double DistanceAlong(const Curve& curve, const Intrinsics& in, double u_px, double v_px, double du, double dv,
                     double start_px, int steps = 4) {
  double distance = start_px;
  for (int i = 0; i < steps; ++i) {
    const CurveRow<Curve::kDim> r = curve.Row(in, u_px + distance * du, v_px + distance * dv);
    const double slope = (r.row_u.dot(curve.p) - r.rhs_u) * du + (r.row_v.dot(curve.p) - r.rhs_v) * dv;
    distance -= (r.row.dot(curve.p) - r.rhs) / slope;
  }
  return distance;
}

// Fills `points` with points of the ellipse at equal angles about its centre.
void EllipsePoints(const Eigen::Matrix3d& conic, std::span<Eigen::Vector2d> points);

}  // namespace fovea::vision
