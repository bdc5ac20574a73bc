#include "firmware/vision/fit/outline.hpp"

#include <cmath>
#include <numbers>

#include "firmware/core/features/sphere.hpp"
#include "firmware/vision/detect/polygon_detector.hpp"
#include "firmware/vision/find/curve.hpp"

namespace fovea::vision {

std::vector<ImagePoint> SphereOutline(const Intrinsics& intrinsics, const model::Vec3& m, int count) {
  ConeCurve cone;
  cone.p = m;
  std::vector<Eigen::Vector2d> ellipse(static_cast<std::size_t>(count));
  EllipsePoints(cone.Conic(intrinsics), ellipse);
  std::vector<ImagePoint> points;
  points.reserve(ellipse.size());
  for (const Eigen::Vector2d& p : ellipse) {
    points.push_back({p.x(), p.y()});
  }
  return points;
}

std::vector<ImagePoint> TargetOutline(const DetectorConfig& config, const model::Pose& X_CO) {
  constexpr double kNearest = 1e-3;  // [m]
  const double radius = 0.5 * config.size;
  const features::TargetBody body = features::TraitsOf(config.kind).body;
  if (body == features::TargetBody::kBall) {
    return X_CO.p.z() > 1.1 * radius
               ? SphereOutline(config.intrinsics, features::ConeFromSphere(X_CO.p / radius),
                               Detection::kOutlinePoints)
               : std::vector<ImagePoint>();
  }
  std::vector<Eigen::Vector2d> rim;
  if (body == features::TargetBody::kDisc) {
    for (int i = 0; i < Detection::kOutlinePoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / Detection::kOutlinePoints;
      rim.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  } else {
    rim = CornersOf(config);
  }
  std::vector<ImagePoint> points;
  points.reserve(rim.size());
  for (const Eigen::Vector2d& q : rim) {
    const model::Vec3 p = X_CO * model::Vec3(q.x(), q.y(), 0.0);
    if (!(p.z() > kNearest)) {
      return {};
    }
    points.push_back({config.intrinsics.U(p), config.intrinsics.V(p)});
  }
  return points;
}

}  // namespace fovea::vision
