// SPDX-License-Identifier: Apache-2.0
// Checks outlines by another method: the ray through each outline point must touch the target's edge.
#include "firmware/host/film/target_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
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

// The point [m, in C] where the ray through an image point is nearest
// to a ball's centre, or meets the plane of a flat target.
Vec3 MetBy(const TargetFeature& target, const model::Pose& X_CO, const vision::ImagePoint& point) {
  const Vec3 ray = kCamera.Ray(point.u_px, point.v_px).normalized();
  if (features::TraitsOf(target.target).body == features::TargetBody::kBall) {
    return X_CO.p.dot(ray) * ray;
  }
  const Vec3 normal = X_CO.R.col(2);
  return normal.dot(X_CO.p) / normal.dot(ray) * ray;
}

// Distance of that point from the target's edge [m].
double OffOf(const TargetFeature& target, const model::Pose& X_CO, const Vec3& p_C) {
  if (!target.SeesOrientation()) {
    return std::fabs((p_C - X_CO.p).norm() - target.radius);
  }
  const Vec3 p_O = X_CO.Inverse() * p_C;
  double least = HUGE_VAL;
  const auto n = static_cast<std::size_t>(target.corners.num_corners);
  for (std::size_t i = 0; i < n; ++i) {
    least = std::min(least, OffSide(p_O, target.corners.corners[i], target.corners.corners[(i + 1) % n]));
  }
  return least;
}

// Length of the visible edge [m]; for a ball, of the circle where the view cone touches it.
double Around(const TargetFeature& target, const model::Pose& X_CO) {
  const int n = target.SeesOrientation() ? target.corners.num_corners : 0;
  double around = 0.0;
  for (int i = 0; i < n; ++i) {
    const auto& corners = target.corners.corners;
    around += (corners[static_cast<std::size_t>(i)] - corners[static_cast<std::size_t>((i + 1) % n)]).norm();
  }
  if (n > 0) {
    return around;
  }
  const bool is_ball = features::TraitsOf(target.target).body == features::TargetBody::kBall;
  const double sine = is_ball ? target.radius / X_CO.p.norm() : 0.0;
  return 2.0 * std::numbers::pi * target.radius * std::sqrt(1.0 - sine * sine);
}

TEST(TargetCurveTest, CurveFollowsTheTargetsEdge) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (const features::TargetTraits& traits : features::kTargets) {
    const TargetFeature target = Target(traits.kind);
    double worst = 0.0;
    double least_share = 1.0;
    for (int i = 0; i < 200; ++i) {
      const model::Pose X_CO{model::RotationOf(Vec3(any(random), any(random), any(random))),
                             Vec3(0.1 * any(random), 0.1 * any(random), 0.45 + 0.2 * any(random))};
      const Overlay::Curve curve = TargetCurve(kCamera, target, X_CO);
      ASSERT_GE(curve.size(), 90U);
      double way = 0.0;
      Vec3 before = MetBy(target, X_CO, curve.back());
      for (const vision::ImagePoint& point : curve) {
        const Vec3 p_C = MetBy(target, X_CO, point);
        worst = std::max(worst, OffOf(target, X_CO, p_C));
        way += (p_C - before).norm();
        before = p_C;
      }
      const double share = way / Around(target, X_CO);
      least_share = std::min(least_share, share);
      ASSERT_LT(share, 1.0 + 1e-12) << "the curve turns back or crosses itself";
    }
    std::cout << traits.name << ": rays miss the edge by at most " << worst << " m and cover at least "
              << least_share << " of its length\n";
    EXPECT_LT(worst, 1e-12);
    EXPECT_GT(least_share, 0.9998);  // 96 chords of a circle: 1 - (pi / 96)^2 / 6
  }
}

TEST(TargetCurveTest, NoCurveForATargetPartlyBehindTheCamera) {
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
