// SPDX-License-Identifier: Apache-2.0
// The circle feature: against equation B3, finite differences, and the translational block and depth formula
// of the course exercises.
#include "firmware/core/features/circle.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/features/sphere.hpp"
#include "tests/core/features/camera_steps.hpp"

namespace fovea::features {
namespace {

using model::Mat3;
using model::Vec3;

TEST(CircleFeatureTest, InteractionMatrixMatchesFiniteDifferences) {
  const double worst = test::WorstDerivative(CircleFeature{}, 0.0, 41, 2000);
  std::cout << "worst relative difference over 2000 poses: " << worst << "\n";
  EXPECT_LT(worst, 1e-8);
}

// In pixels it is THEORY B3, whose left half is getImageJacobianCFToFF of the course exercises.
TEST(CircleFeatureTest, InteractionMatrixInPixelsEqualsTheoryB3) {
  test::RandomStates random(42);
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const CircleFeature feature{0.08, random.Uniform(300.0, 900.0), {0.0, 0.0, 0.4}};
    const TargetInCamera seen = test::RandomView(random, 0.0);
    const double f = feature.f;
    const double Z = seen.X_CO.p.z();
    const double u = f * seen.X_CO.p.x() / Z;
    const double v = f * seen.X_CO.p.y() / Z;
    const double d = f * feature.diameter / Z;
    Eigen::Matrix<double, 3, 6> B3;
    B3 << -f / Z, 0, u / Z, u * v / f, -(f + u * u / f), v,  //
        0, -f / Z, v / Z, f + v * v / f, -u * v / f, -u,     //
        0, 0, d / Z, d * v / f, -d * u / f, 0;
    FeatureState state;
    ASSERT_TRUE(feature.Compute(seen, state));
    worst = std::max(worst, (state.L_s - B3).norm() / B3.norm());
    EXPECT_LT((state.s - Vec3(u, v, d)).norm(), 1e-10);
  }
  std::cout << "worst relative difference from B3: " << worst << "\n";
  EXPECT_LT(worst, 1e-14);
}

TEST(CircleFeatureTest, LiftInvertsComputeAndMapsTheCovariance) {
  const CircleFeature feature{0.08, 1.0, {0.0, 0.0, 0.4}};
  TargetInCamera seen;
  seen.X_CO.p = {0.05, -0.08, 0.55};
  FeatureState state;
  ASSERT_TRUE(feature.Compute(seen, state));
  const Mat3 cov_s = Vec3(1e-6, 2e-6, 4e-6).asDiagonal();
  Vec3 p;
  Mat3 cov_p;
  ASSERT_TRUE(feature.Lift(state.s, cov_s, p, cov_p));
  EXPECT_LT((p - seen.X_CO.p).norm(), 1e-15);
  Mat3 dp_ds;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    Vec3 plus, minus;
    Mat3 unused;
    ASSERT_TRUE(feature.Lift(Vec3(state.s) + kStep * Vec3::Unit(i), cov_s, plus, unused));
    ASSERT_TRUE(feature.Lift(Vec3(state.s) - kStep * Vec3::Unit(i), cov_s, minus, unused));
    dp_ds.col(i) = (plus - minus) / (2.0 * kStep);
  }
  const double worst = (cov_p - dp_ds * cov_s * dp_ds.transpose()).norm() / cov_p.norm();
  std::cout << "covariance off by " << worst << " relative\n";
  EXPECT_LT(worst, 1e-8);
}

// For a sphere the simple depth formula errs by 2 mm at 0.4 m: therefore the sphere has its own feature.
TEST(CircleFeatureTest, SimpleDepthFormulaOfASphereErrsByHalfAPercent) {
  const double f = 554.256;
  const double R = 0.04;
  const double Z = 0.4;
  const double r_px = f * R / std::sqrt(Z * Z - R * R);  // of the silhouette, on the axis
  const double simple = DepthFromRadius(f, 2.0 * R, r_px);
  std::cout << "sphere at 0.4 m: simple depth off by " << 1e3 * (simple - Z) << " mm, "
            << 100.0 * (simple / Z - 1.0) << " %\n";
  EXPECT_NEAR(simple - Z, -2.005e-3, 1e-6);
  EXPECT_NEAR(DepthFromRadius(f, 0.08, f * 0.04 / Z), Z, 1e-15) << "a disc that faces the camera";
  // The exact form, from the same silhouette.
  const double m = std::sqrt(1.0 + (r_px / f) * (r_px / f));  // |m| = 1 / cos(theta)
  Vec3 s;
  Mat3 unused;
  ASSERT_TRUE(SphereFromCone({0.0, 0.0, m}, s, unused));
  EXPECT_NEAR(s.z() * R, Z, 1e-13);
}

TEST(CircleFeatureTest, RefusesACircleNotInFrontOfTheCamera) {
  const double nan = std::nan("");
  const CircleFeature feature;
  FeatureState state;
  state.s = FeatureVector::Constant(3, 7.0);
  TargetInCamera seen;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0, 0, 0.009), Vec3(0, 0, -0.4), Vec3(nan, 0, 0.4)}) {
    seen.X_CO.p = p;
    EXPECT_FALSE(feature.Compute(seen, state)) << p.transpose();
  }
  seen.X_CO.p = {0, 0, 0.4};
  seen.v_BO_C = {0, nan, 0};
  EXPECT_FALSE(feature.Compute(seen, state));
  EXPECT_EQ(state.s[0], 7.0) << "untouched";
  Vec3 p;
  Mat3 cov;
  EXPECT_FALSE(feature.Lift({0, 0, 0}, Mat3::Identity(), p, cov));
  EXPECT_FALSE(feature.Lift({0, 0, -0.2}, Mat3::Identity(), p, cov));
  EXPECT_FALSE(feature.Lift({0, 0, 9.0}, Mat3::Identity(), p, cov)) << "nearer than kMinDepth";
  EXPECT_FALSE(feature.Lift({nan, 0, 0.2}, Mat3::Identity(), p, cov));
}

}  // namespace
}  // namespace fovea::features
