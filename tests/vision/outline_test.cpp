// Outlines by another way: a ray through each of their points meets the target where it ends.
#include "firmware/vision/fit/outline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <random>

#include "firmware/core/model/rotation.hpp"

namespace fovea::vision {
namespace {

using model::Vec3;

constexpr double kSize = 0.09;

DetectorConfig ConfigOf(hal::FeatureKind kind) {
  DetectorConfig config;
  config.kind = kind;
  config.size = kSize;
  config.intrinsics = {640, 480, 560.0, 555.0, 322.0, 236.0};
  return config;
}

model::Pose Draw(std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  return {model::RotationOf(Vec3(any(random), any(random), any(random))),
          Vec3(0.1 * any(random), 0.1 * any(random), 0.45 + 0.2 * any(random))};
}

// How far from where it should be a ray meets the target [m].
double OffOf(const DetectorConfig& config, const model::Pose& X_CO, const ImagePoint& point,
             std::size_t index) {
  const Vec3 ray = config.intrinsics.Ray(point.u_px, point.v_px).normalized();
  if (config.kind == hal::FeatureKind::kSphere) {
    return (X_CO.p - X_CO.p.dot(ray) * ray).norm() - 0.5 * kSize;
  }
  const Vec3 normal = X_CO.R.col(2);
  const Vec3 p_O = X_CO.Inverse() * (normal.dot(X_CO.p) / normal.dot(ray) * ray);
  if (config.kind == hal::FeatureKind::kCircle) {
    return p_O.norm() - 0.5 * kSize;
  }
  if (config.kind == hal::FeatureKind::kSquare) {
    return (p_O.cwiseAbs() - Vec3(0.5 * kSize, 0.5 * kSize, 0.0)).norm();
  }
  const Eigen::Vector2d mean = (config.triangle[0] + config.triangle[1] + config.triangle[2]) / 3.0;
  constexpr std::array<std::size_t, 3> kTurned{0, 2, 1};  // this one is given clockwise, seen along z_O
  return (p_O.head<2>() - (config.triangle[kTurned[index]] - mean)).norm();
}

TEST(OutlineTest, RaysThroughItMeetTheTargetsEdge) {
  std::mt19937_64 random(11);
  for (const auto kind : {hal::FeatureKind::kSphere, hal::FeatureKind::kCircle, hal::FeatureKind::kSquare,
                          hal::FeatureKind::kTriangle}) {
    const DetectorConfig config = ConfigOf(kind);
    double worst = 0.0;
    for (int i = 0; i < 200; ++i) {
      const model::Pose X_CO = Draw(random);
      const std::vector<ImagePoint> outline = TargetOutline(config, X_CO);
      const std::size_t expected = kind == hal::FeatureKind::kSquare     ? 4
                                   : kind == hal::FeatureKind::kTriangle ? 3
                                                                         : Detection::kOutlinePoints;
      ASSERT_EQ(outline.size(), expected);
      for (std::size_t k = 0; k < outline.size(); ++k) {
        worst = std::max(worst, std::fabs(OffOf(config, X_CO, outline[k], k)));
      }
    }
    std::cout << "kind " << static_cast<int>(kind) << ": rays miss the edge by at most " << worst << " m\n";
    EXPECT_LT(worst, 1e-12);
  }
}

TEST(OutlineTest, ThereIsNoneOfWhatIsPartlyBehindTheCamera) {
  for (const auto kind : {hal::FeatureKind::kSphere, hal::FeatureKind::kCircle, hal::FeatureKind::kSquare,
                          hal::FeatureKind::kTriangle}) {
    const DetectorConfig config = ConfigOf(kind);
    model::Pose X_CO{model::RotationOf(Vec3(1.3, 0.0, 0.0)), Vec3(0.0, 0.0, -0.4)};
    EXPECT_TRUE(TargetOutline(config, X_CO).empty()) << static_cast<int>(kind) << " behind";
    X_CO.p.z() = 0.5 * kSize * std::sin(1.3) * 0.5;
    EXPECT_TRUE(TargetOutline(config, X_CO).empty()) << static_cast<int>(kind) << " half behind";
  }
}

}  // namespace
}  // namespace fovea::vision
