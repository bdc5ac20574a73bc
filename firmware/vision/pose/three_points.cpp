// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/pose/three_points.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

// Axes from three points: x from the first to the second, z normal to their plane.
Mat3 AxesOf(const std::array<Vec3, 3>& points) {
  Mat3 R;
  R.col(0) = (points[1] - points[0]).normalized();
  R.col(2) = R.col(0).cross(points[2] - points[0]).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

struct Roots {
  int count = 0;
  std::array<double, 4> real{};
};

// Roots of c[4] x^4 + ... + c[0], real ones refined by Newton's method; of complex roots the real part.
Roots RootsOf(const std::array<double, 5>& c) {
  constexpr int kNewtons = 3;
  Roots roots;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    companion(i, 3) = -c[static_cast<std::size_t>(i)] / c[4];
    if (i > 0) {
      companion(i, i - 1) = 1.0;
    }
  }
  if (!companion.allFinite()) {
    return roots;
  }
  const Eigen::EigenSolver<Eigen::Matrix4d> solver(companion, false);
  if (solver.info() != Eigen::Success) {
    return roots;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    double x = solver.eigenvalues()[i].real();
    for (int k = 0; k < kNewtons && solver.eigenvalues()[i].imag() == 0.0; ++k) {
      const double value = (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
      const double slope = ((4.0 * c[4] * x + 3.0 * c[3]) * x + 2.0 * c[2]) * x + c[1];
      const double step = slope != 0.0 ? value / slope : 0.0;
      x -= std::fabs(step) < 1e-3 ? step : 0.0;
    }
    roots.real[static_cast<std::size_t>(roots.count++)] = x;
  }
  return roots;
}

// In Grunert's notation: cosines between the rays to three points, and squared distances between the points.
struct Triangle {
  double ca, cb, cg;
  double a2, b2, c2;
};

Vec3 Residual(const Triangle& t, const Vec3& d) {
  return {d[1] * d[1] + d[2] * d[2] - 2.0 * d[1] * d[2] * t.ca - t.a2,
          d[0] * d[0] + d[2] * d[2] - 2.0 * d[0] * d[2] * t.cb - t.b2,
          d[0] * d[0] + d[1] * d[1] - 2.0 * d[0] * d[1] * t.cg - t.c2};
}

// Solves the three laws of cosines for the points' distances `d` by Newton's method. True if they hold then.
bool Polish(const Triangle& t, Vec3& d) {
  constexpr int kNewtons = 8;
  constexpr double kHolds = 1e-10;
  Vec3 r = Residual(t, d);
  for (int k = 0; k < kNewtons; ++k) {
    Mat3 half_slope;
    half_slope << 0.0, d[1] - d[2] * t.ca, d[2] - d[1] * t.ca,  //
        d[0] - d[2] * t.cb, 0.0, d[2] - d[0] * t.cb,            //
        d[0] - d[1] * t.cg, d[1] - d[0] * t.cg, 0.0;
    const Vec3 next = d - 0.5 * (half_slope.inverse() * r);
    const Vec3 r_next = Residual(t, next);
    if (!(r_next.squaredNorm() < r.squaredNorm())) {
      break;
    }
    d = next;
    r = r_next;
  }
  return r.lpNorm<Eigen::Infinity>() < kHolds * (t.a2 + t.b2 + t.c2);
}

// The points' distances from the camera, for values of `v`, the third distance over the first.
class Distances {
 public:
  explicit Distances(const Triangle& triangle) : t_(triangle) {}

  void Add(double v) {
    const double q = (t_.a2 - t_.c2) / t_.b2;
    const double below = 2.0 * (t_.cg - v * t_.ca);
    const double u = ((q - 1.0) * v * v - 2.0 * q * t_.cb * v + 1.0 + q) / below;
    const double first2 = t_.b2 / (1.0 + v * v - 2.0 * v * t_.cb);
    if (!(v > 0.0) || !(first2 > 0.0)) {
      return;
    }
    const double first = std::sqrt(first2);
    if (std::fabs(below) >= kLeastDivisor) {
      Keep({first, u * first, v * first});
      return;
    }
    // The quotient u is inaccurate here. The law of cosines between the first and second point has two
    // solutions. Both may be right: then this v is a double root.
    const double root = std::sqrt(std::max(0.0, t_.cg * t_.cg - 1.0 + t_.c2 / first2));
    bool found = false;
    for (const double either : {t_.cg + root, t_.cg - root}) {
      Vec3 d(first, either * first, v * first);
      // Otherwise Newton's method has moved to the solution of another v.
      if (Polish(t_, d) && std::fabs(d[2] - v * d[0]) < kSameRatio * d[2]) {
        found = true;
        if (!Knows(d)) {
          Keep(d);
        }
      }
    }
    if (!found) {
      Keep({first, u * first, v * first});
    }
  }
  [[nodiscard]] std::span<const Vec3> all() const { return std::span(kept_).first(count_); }

 private:
  static constexpr double kLeastDivisor = 0.01;
  static constexpr double kSame = 1e-9;  // [m]
  static constexpr double kSameRatio = 1e-4;

  void Keep(const Vec3& d) {
    if (count_ < kept_.size() && d.allFinite() && d.minCoeff() > 0.0) {
      kept_[count_++] = d;
    }
  }
  [[nodiscard]] bool Knows(const Vec3& d) const {
    const auto known = all();
    return std::any_of(known.begin(), known.end(),
                       [&d](const Vec3& other) { return (d - other).norm() < kSame; });
  }

  const Triangle t_;
  std::array<Vec3, 4> kept_;
  std::size_t count_ = 0;
};

}  // namespace

ThreePointPoses PosesOfThreePoints(const std::array<Vec3, 3>& points_O, const std::array<Vec3, 3>& rays_C) {
  const double a2 = (points_O[1] - points_O[2]).squaredNorm();
  const double b2 = (points_O[0] - points_O[2]).squaredNorm();
  const double c2 = (points_O[0] - points_O[1]).squaredNorm();
  const double ca = rays_C[1].dot(rays_C[2]);
  const double cb = rays_C[0].dot(rays_C[2]);
  const double cg = rays_C[0].dot(rays_C[1]);
  const double q = (a2 - c2) / b2;
  const double s = (a2 + c2) / b2;
  const double c = c2 / b2;
  const double a = a2 / b2;
  // A polynomial in v, the third distance over the first.
  const std::array<double, 5> quartic{
      (1.0 + q) * (1.0 + q) - 4.0 * a * cg * cg,
      4.0 * (-q * (1.0 + q) * cb + 2.0 * a * cg * cg * cb - (1.0 - s) * ca * cg),
      2.0 * (q * q - 1.0 + 2.0 * q * q * cb * cb + 2.0 * (1.0 - c) * ca * ca - 4.0 * s * ca * cb * cg +
             2.0 * (1.0 - a) * cg * cg),
      4.0 * (q * (1.0 - q) * cb - (1.0 - s) * ca * cg + 2.0 * c * ca * ca * cb),
      (q - 1.0) * (q - 1.0) - 4.0 * c * ca * ca};
  const Mat3 R_O = AxesOf(points_O);
  const Vec3 middle_O = (points_O[0] + points_O[1] + points_O[2]) / 3.0;
  const Roots roots = RootsOf(quartic);
  Distances distances({ca, cb, cg, a2, b2, c2});
  for (int i = 0; i < roots.count; ++i) {
    distances.Add(roots.real[static_cast<std::size_t>(i)]);
  }
  ThreePointPoses poses;
  for (const Vec3& d : distances.all()) {
    const std::array<Vec3, 3> points_C{d[0] * rays_C[0], d[1] * rays_C[1], d[2] * rays_C[2]};
    model::Pose& X_CO = poses.X_CO[static_cast<std::size_t>(poses.count)];
    X_CO.R = AxesOf(points_C) * R_O.transpose();
    X_CO.p = (points_C[0] + points_C[1] + points_C[2]) / 3.0 - X_CO.R * middle_O;
    poses.count += X_CO.R.allFinite() && X_CO.p.allFinite() ? 1 : 0;
  }
  return poses;
}

}  // namespace fovea::vision
