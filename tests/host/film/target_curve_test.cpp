// Outlines by another way: a ray through each of their points meets the target where it ends.
#include "firmware/host/film/target_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::film {
namespace {

using features::TargetFeature;
using model::Vec3;

constexpr double kSize = 0.09;
const vision::Intrinsics kCamera{640, 480, 560.0, 555.0, 322.0, 236.0, {}};

TargetFeature Target(hal::FeatureKind kind) {
  TargetFeature target;
  target.target = kind;
  target.radius = 0.5 * kSize;
  if (kind == hal::FeatureKind::kSquare) {
    target.corners = features::MakeSquare(kSize);
  } else if (kind == hal::FeatureKind::kTriangle) {
    target.corners = features::MakeTriangle(features::kDefaultTriangle);
  }
  return target;
}

double OffSide(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double share = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - share * (b - a)).norm();
}

// How far from the target's edge a ray through the picture's point meets it [m].
double OffOf(const TargetFeature& target, const model::Pose& X_CO, const vision::ImagePoint& point) {
  const Vec3 ray = kCamera.Ray(point.u_px, point.v_px).normalized();
  const features::TargetBody body = features::TraitsOf(target.target).body;
  if (body == features::TargetBody::kBall) {
    return std::fabs((X_CO.p - X_CO.p.dot(ray) * ray).norm() - target.radius);
  }
  const Vec3 normal = X_CO.R.col(2);
  const Vec3 p_O = X_CO.Inverse() * (normal.dot(X_CO.p) / normal.dot(ray) * ray);
  if (body == features::TargetBody::kDisc) {
    return std::fabs(p_O.norm() - target.radius);
  }
  double least = HUGE_VAL;
  const auto n = static_cast<std::size_t>(target.corners.num_corners);
  for (std::size_t i = 0; i < n; ++i) {
    least = std::min(least, OffSide(p_O, target.corners.corners[i], target.corners.corners[(i + 1) % n]));
  }
  return least;
}

TEST(TargetCurveTest, RaysThroughItMeetTheTargetsEdge) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (const features::TargetTraits& traits : features::kTargets) {
    const TargetFeature target = Target(traits.kind);
    double worst = 0.0;
    for (int i = 0; i < 200; ++i) {
      const model::Pose X_CO{model::RotationOf(Vec3(any(random), any(random), any(random))),
                             Vec3(0.1 * any(random), 0.1 * any(random), 0.45 + 0.2 * any(random))};
      const Overlay::Curve curve = TargetCurve(kCamera, target, X_CO);
      ASSERT_GE(curve.size(), 90U);
      for (const vision::ImagePoint& point : curve) {
        worst = std::max(worst, OffOf(target, X_CO, point));
      }
    }
    std::cout << traits.name << ": rays miss the edge by at most " << worst << " m\n";
    EXPECT_LT(worst, 1e-12);
  }
}

TEST(TargetCurveTest, ThereIsNoneOfWhatIsPartlyBehindTheCamera) {
  for (const features::TargetTraits& traits : features::kTargets) {
    const TargetFeature target = Target(traits.kind);
    model::Pose X_CO{model::RotationOf(Vec3(1.3, 0.0, 0.0)), Vec3(0.0, 0.0, -0.4)};
    EXPECT_TRUE(TargetCurve(kCamera, target, X_CO).empty()) << traits.name << " behind";
    X_CO.p.z() = 0.5 * kSize * std::sin(1.3) * 0.5;
    EXPECT_TRUE(TargetCurve(kCamera, target, X_CO).empty()) << traits.name << " half behind";
  }
}

}  // namespace
}  // namespace fovea::film
