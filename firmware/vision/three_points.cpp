#include "fovea/vision/three_points.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

// Axes that three points give: x from the first to the second, z across their plane.
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

// Of c[4] x^4 + ... + c[0]; of those that are not real, the real part. Newton's method has the last word.
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
  // In v, the third distance over the first.
  const std::array<double, 5> quartic{
      (1.0 + q) * (1.0 + q) - 4.0 * a * cg * cg,
      4.0 * (-q * (1.0 + q) * cb + 2.0 * a * cg * cg * cb - (1.0 - s) * ca * cg),
      2.0 * (q * q - 1.0 + 2.0 * q * q * cb * cb + 2.0 * (1.0 - c) * ca * ca - 4.0 * s * ca * cb * cg +
             2.0 * (1.0 - a) * cg * cg),
      4.0 * (q * (1.0 - q) * cb - (1.0 - s) * ca * cg + 2.0 * c * ca * ca * cb),
      (q - 1.0) * (q - 1.0) - 4.0 * c * ca * ca};
  const Mat3 R_O = AxesOf(points_O);
  const Vec3 middle_O = (points_O[0] + points_O[1] + points_O[2]) / 3.0;
  ThreePointPoses poses;
  const Roots roots = RootsOf(quartic);
  for (int i = 0; i < roots.count; ++i) {
    const double v = roots.real[static_cast<std::size_t>(i)];
    const double below = 2.0 * (cg - v * ca);
    const double u = ((q - 1.0) * v * v - 2.0 * q * cb * v + 1.0 + q) / below;
    const double first2 = b2 / (1.0 + v * v - 2.0 * v * cb);
    if (!(v > 0.0) || !(u > 0.0) || !(first2 > 0.0) || !std::isfinite(u)) {
      continue;
    }
    const double first = std::sqrt(first2);
    const std::array<Vec3, 3> points_C{first * rays_C[0], u * first * rays_C[1], v * first * rays_C[2]};
    model::Pose& X_CO = poses.X_CO[static_cast<std::size_t>(poses.count)];
    X_CO.R = AxesOf(points_C) * R_O.transpose();
    X_CO.p = (points_C[0] + points_C[1] + points_C[2]) / 3.0 - X_CO.R * middle_O;
    poses.count += X_CO.R.allFinite() && X_CO.p.allFinite() ? 1 : 0;
  }
  return poses;
}

}  // namespace fovea::vision
