#include "fovea/vision/outline_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "fovea/vision/edges.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

constexpr int kMinRays = 48;
constexpr double kMinRms = 0.02;    // edges are never trusted beyond this [px]
constexpr double kCommonPx = 0.05;  // what shading and lens may move the whole outline in or out [px]
constexpr double kAsidePx = 0.04;   // and what light from one side may move it along u and along v [px]
constexpr double kPi = 3.14159265358979323846;

// Distance of the outline's function |x| - x . m from zero, per pixel along the ray.
double Slope(const Intrinsics& in, const Vec3& m, const Vec3& x, double du, double dv) {
  const Vec3 along(du / in.f_u_px, dv / in.f_v_px, 0.0);
  return along.dot(x) / x.norm() - along.dot(m);
}

double Residual(const Intrinsics& in, const Vec3& m, const Edge& edge) {
  const Vec3 x = in.Ray(edge.u_px, edge.v_px);
  return (x.norm() - x.dot(m)) / Slope(in, m, x, edge.du, edge.dv);
}

// Tukey's biweight: 1 at 0, 0 beyond `limit`.
double Weight(double residual, double limit) {
  const double t = residual / limit;
  return std::fabs(t) >= 1.0 ? 0.0 : (1.0 - t * t) * (1.0 - t * t);
}

double MedianSize(const Intrinsics& in, const Vec3& m, const EdgeSet& edges) {
  std::array<double, EdgeSet::kMaxRays> sizes;
  for (int i = 0; i < edges.count; ++i) {
    sizes[static_cast<std::size_t>(i)] = std::fabs(Residual(in, m, edges.list[static_cast<std::size_t>(i)]));
  }
  const auto middle = sizes.begin() + edges.count / 2;
  std::nth_element(sizes.begin(), middle, sizes.begin() + edges.count);
  return *middle;
}

struct ConeFit {
  bool ok = false;
  Vec3 m = Vec3::Zero();
  Mat3 cov = Mat3::Zero();
  double rms_px = 0.0;
  int inliers = 0;
};

// Weighted least squares of x_i . m = |x_i|, the equation of each edge in pixels, reweighted a few times.
ConeFit FitCone(const Intrinsics& in, const EdgeSet& edges, const Vec3& start, double min_scale_px) {
  constexpr int kRounds = 6;
  ConeFit fit;
  fit.m = start;
  if (edges.count < kMinRays / 3) {
    return fit;
  }
  for (int round = 0; round < kRounds; ++round) {
    // 1.4826 makes the median of sizes a standard deviation; Tukey's constant is 4.685 of those.
    const double limit = 4.685 * std::max(1.4826 * MedianSize(in, fit.m, edges), min_scale_px);
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    Vec3 common = Vec3::Zero();   // what an equal shift of all edges does
    Vec3 aside_u = Vec3::Zero();  // and one along u or v
    Vec3 aside_v = Vec3::Zero();
    double sum = 0.0;
    double weights = 0.0;
    fit.inliers = 0;
    for (int i = 0; i < edges.count; ++i) {
      const Edge& edge = edges.list[static_cast<std::size_t>(i)];
      const Vec3 x = in.Ray(edge.u_px, edge.v_px);
      const double slope = Slope(in, fit.m, x, edge.du, edge.dv);
      const double residual = (x.norm() - x.dot(fit.m)) / slope;
      const double w = Weight(residual, limit);
      const Vec3 row = x / slope;
      normal += w * row * row.transpose();
      right += w * row * (x.norm() / slope);
      common += w * row;
      aside_u += w * edge.du * row;
      aside_v += w * edge.dv * row;
      sum += w * residual * residual;
      weights += w;
      fit.inliers += w > 0.2 ? 1 : 0;
    }
    const Mat3 inverse = normal.inverse();
    if (!(weights > kMinRays / 4.0) || !inverse.allFinite()) {
      fit.ok = false;
      return fit;
    }
    fit.m = inverse * right;
    fit.rms_px = std::sqrt(sum / weights);
    const double sigma = std::max(fit.rms_px, kMinRms);
    fit.cov = sigma * sigma * inverse;
    for (const Vec3& shift : {Vec3(kCommonPx * common), Vec3(kAsidePx * aside_u), Vec3(kAsidePx * aside_v)}) {
      const Vec3 dm = inverse * shift;
      fit.cov += dm * dm.transpose();
    }
  }
  fit.ok = fit.m.allFinite() && fit.m.squaredNorm() > 1.0 && fit.m.z() > 0.0;
  return fit;
}

// The cone of a circle in the image, near enough to start from.
Vec3 ConeOfCircle(const Intrinsics& in, const Circle& circle) {
  const Vec3 centre = in.Ray(circle.u_px, circle.v_px);
  const Vec3 rim = in.Ray(circle.u_px + circle.radius_px, circle.v_px);
  const double c = centre.dot(rim) / (centre.norm() * rim.norm());
  return centre / (centre.norm() * c);
}

int RayCount(double radius_px) {
  return std::clamp(static_cast<int>(2.0 * kPi * radius_px / 1.5), kMinRays, EdgeSet::kMaxRays);
}

// Rays to a circle.
RayFan FanOfCircle(const Circle& circle) {
  RayFan fan{circle.u_px, circle.v_px, kMinRays, {}};
  fan.distance_px.fill(circle.radius_px);
  return fan;
}

// Rays to the outline of cone `m`.
RayFan FanOfCone(const Intrinsics& in, const Vec3& m, double radius_px) {
  RayFan fan{in.U(m), in.V(m), RayCount(radius_px), {}};
  double distance = radius_px;
  for (int i = 0; i < fan.rays; ++i) {
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(i, du, dv);
    distance = OutlineDistance(in, m, fan.u_px, fan.v_px, du, dv, distance);
    fan.distance_px[static_cast<std::size_t>(i)] = distance;
  }
  return fan;
}

// Centre and mean radius of the outline, from a few of its points.
void Describe(const Intrinsics& in, const Vec3& m, OutlineFit& fit) {
  constexpr int kPoints = 64;
  const RayFan fan{in.U(m), in.V(m), kPoints, {}};
  double radius = fit.radius_px;
  double su = 0.0;
  double sv = 0.0;
  double area = 0.0;
  double last_u = 0.0;
  double last_v = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    double du = 0.0;
    double dv = 0.0;
    fan.Direction(i, du, dv);
    radius = OutlineDistance(in, m, fan.u_px, fan.v_px, du, dv, radius);
    const double u = radius * du;
    const double v = radius * dv;
    if (i > 0) {
      const double cross = last_u * v - u * last_v;  // twice the triangle's area
      area += 0.5 * cross;
      su += cross * (last_u + u) / 6.0;
      sv += cross * (last_v + v) / 6.0;
    }
    last_u = u;
    last_v = v;
  }
  fit.u_px = fan.u_px + su / area;
  fit.v_px = fan.v_px + sv / area;
  // A polygon inside an outline misses this share of its area.
  const double polygon_share = kPoints / (2.0 * kPi) * std::sin(2.0 * kPi / kPoints);
  fit.radius_px = std::sqrt(std::fabs(area) / (kPi * polygon_share));
}

}  // namespace

double OutlineDistance(const Intrinsics& intrinsics, const Vec3& m, double u_px, double v_px, double du,
                       double dv, double start_px) {
  constexpr int kNewtonSteps = 3;
  double distance = start_px;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vec3 x = intrinsics.Ray(u_px + distance * du, v_px + distance * dv);
    distance -= (x.norm() - x.dot(m)) / Slope(intrinsics, m, x, du, dv);
  }
  return distance;
}

OutlineFit FitOutline(const cv::Mat& image, const Intrinsics& in, const Circle& start, double search_px) {
  OutlineFit fit;
  if (start.u_px < 0.0 || start.v_px < 0.0 || start.u_px > image.cols - 1 || start.v_px > image.rows - 1) {
    return fit;
  }
  EdgeSet edges;
  FindCoarseEdges(image, FanOfCircle(start), search_px, edges);
  ConeFit cone = FitCone(in, edges, ConeOfCircle(in, start), 0.5);
  if (!cone.ok) {
    return fit;
  }
  fit.radius_px = start.radius_px;
  constexpr int kFineRounds = 3;
  for (int round = 0; round < kFineRounds; ++round) {
    // The shading is told from the edge once the edge is known to less than a pixel.
    MeasureFineEdges(image, FanOfCone(in, cone.m, fit.radius_px), round == 0 ? 0.0 : fit.radius_px, edges);
    cone = FitCone(in, edges, cone.m, 0.05);
    if (!cone.ok) {
      return fit;
    }
    Describe(in, cone.m, fit);
    if (!(fit.radius_px > 1.0) || !std::isfinite(fit.u_px) || !std::isfinite(fit.v_px)) {
      return fit;
    }
  }
  fit.converged = true;
  fit.m = cone.m;
  fit.cov_m = cone.cov;
  fit.rms_px = cone.rms_px;
  fit.contrast = edges.contrast;
  fit.seen = static_cast<double>(cone.inliers) / edges.rays;
  return fit;
}

std::vector<std::pair<double, double>> OutlinePoints(const Intrinsics& in, const model::Vec3& m, int count) {
  std::vector<std::pair<double, double>> points;
  const double u = in.U(m);
  const double v = in.V(m);
  // The radius of a small cone about the axis to start from: tan(theta) f.
  double distance = in.f_u_px * std::sqrt(std::max(m.squaredNorm() - 1.0, 1e-6)) / std::max(m.z(), 0.1);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * CV_PI * i / count;
    const double du = std::cos(angle);
    const double dv = std::sin(angle);
    distance = OutlineDistance(in, m, u, v, du, dv, distance);
    points.emplace_back(u + distance * du, v + distance * dv);
  }
  return points;
}

}  // namespace fovea::vision
