// SPDX-License-Identifier: Apache-2.0
// The sphere feature: its interaction matrix against finite differences, its cone against plain geometry, and
// input that is refused.
#include "firmware/core/features/sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "firmware/core/model/math.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::features {
namespace {

using model::Mat3;
using model::Vec3;
using model::Vec6;

// The centre in camera axes after the camera has moved with the body twist V for dt.
Vec3 AfterMotion(const Vec3& p_CO_C, const Vec6& V, double dt) {
  // Rodrigues for exp([w] dt), and the translation to first order in a small step.
  const Vec3 v = V.head<3>() * dt;
  const Vec3 w = V.tail<3>() * dt;
  const double angle = w.norm();
  Mat3 R = Mat3::Identity();
  if (angle > 0.0) {
    const Mat3 K = model::CrossMatrix(w / angle);
    R += std::sin(angle) * K + (1.0 - std::cos(angle)) * K * K;
  }
  return R.transpose() * (p_CO_C - v);
}

TEST(SphereFeatureTest, InteractionMatrixMatchesFiniteDifferences) {
  test::RandomStates random(5);
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    SphereFeature feature;
    feature.radius = random.Uniform(0.01, 0.1);
    const double z = random.Uniform(0.2, 1.5);
    const Vec3 p(z * random.Uniform(-0.6, 0.6), z * random.Uniform(-0.5, 0.5), z);
    Vec6 V;
    V << random.Vector(0.5), random.Vector(1.0);
    FeatureState state;
    ASSERT_TRUE(feature.Compute(p, Vec3::Zero(), state));
    constexpr double kDt = 1e-5;
    const Vec3 difference = (AfterMotion(p, V, kDt) - AfterMotion(p, V, -kDt)) / (2.0 * kDt * feature.radius);
    const FeatureVector computed = state.L_s * V;
    worst = std::max(worst, (computed - difference).norm() / std::max(1.0, difference.norm()));
  }
  std::cout << "worst relative difference over 2000 poses: " << worst << "\n";
  EXPECT_LT(worst, 1e-8);
}

TEST(SphereFeatureTest, TargetMotionTermEqualsVelocityOverRadius) {
  SphereFeature feature;
  FeatureState state;
  const Vec3 velocity(0.1, -0.2, 0.05);
  ASSERT_TRUE(feature.Compute({0.05, -0.02, 0.4}, velocity, state));
  EXPECT_LT((state.ds_dt_target - velocity / feature.radius).norm(), 1e-15);
}

TEST(SphereFeatureTest, LiftInvertsCompute) {
  SphereFeature feature;
  const Vec3 p(0.03, 0.07, 0.55);
  FeatureState state;
  ASSERT_TRUE(feature.Compute(p, Vec3::Zero(), state));
  const Mat3 cov_s = Vec3(1e-4, 2e-4, 9e-4).asDiagonal();
  Vec3 lifted;
  Mat3 cov;
  ASSERT_TRUE(feature.Lift(state.s, cov_s, lifted, cov));
  EXPECT_LT((lifted - p).norm(), 1e-15);
  EXPECT_LT((cov - cov_s * feature.radius * feature.radius).norm(), 1e-18);
}

// Every ray of the cone touches the sphere: its distance from the centre is the radius.
TEST(SphereConeTest, RaysOfTheConeTouchTheSphere) {
  test::RandomStates random(6);
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    const double radius = random.Uniform(0.01, 0.1);
    const double z = random.Uniform(0.15, 1.0);
    const Vec3 p(z * random.Uniform(-0.6, 0.6), z * random.Uniform(-0.5, 0.5), z);
    const Vec3 m = ConeFromSphere(p / radius);
    for (int i = 0; i < 8; ++i) {
      // Walk outward in the image from the centre until x . m = |x|.
      const double angle = 2.0 * model::kPi * i / 8;
      const Vec3 along(std::cos(angle), std::sin(angle), 0.0);
      Vec3 x = p / p.z();
      double low = 0.0;
      double high = 20.0;
      for (int step = 0; step < 200; ++step) {
        const double middle = 0.5 * (low + high);
        const Vec3 ray = x + middle * along;
        (ray.dot(m) > ray.norm() ? low : high) = middle;
      }
      if (high > 19.0) {
        continue;  // the cone is open on this side
      }
      const Vec3 ray = (x + low * along).normalized();
      worst = std::max(worst, std::abs(model::Cross(ray, p).norm() - radius));
    }
  }
  std::cout << "worst distance from touching: " << worst << " m\n";
  EXPECT_LT(worst, 1e-12);
}

TEST(SphereConeTest, RoundTripIsExactAndDerivativeMatchesFiniteDifferences) {
  test::RandomStates random(7);
  double worst = 0.0;
  double worst_derivative = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double z = random.Uniform(2.0, 30.0);
    const Vec3 s(z * random.Uniform(-0.6, 0.6), z * random.Uniform(-0.5, 0.5), z);
    const Vec3 m = ConeFromSphere(s);
    Vec3 back;
    Mat3 ds_dm;
    ASSERT_TRUE(SphereFromCone(m, back, ds_dm));
    worst = std::max(worst, (back - s).norm() / s.norm());
    const double step = 1e-6 * (m.norm() - 1.0);
    for (int i = 0; i < 3; ++i) {
      Vec3 plus, minus;
      Mat3 unused;
      ASSERT_TRUE(SphereFromCone(m + step * Vec3::Unit(i), plus, unused));
      ASSERT_TRUE(SphereFromCone(m - step * Vec3::Unit(i), minus, unused));
      const Vec3 difference = (plus - minus) / (2.0 * step);
      worst_derivative = std::max(worst_derivative, (ds_dm.col(i) - difference).norm() / ds_dm.norm());
    }
  }
  std::cout << "round trip " << worst << " relative, derivative " << worst_derivative << " relative\n";
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(worst_derivative, 1e-6);
}

TEST(SphereFeatureTest, RefusesASphereNotInFrontOfTheCamera) {
  const double nan = std::nan("");
  SphereFeature feature;
  FeatureState state;
  state.s = FeatureVector::Constant(3, 7.0);
  for (const Vec3& p : {Vec3(0, 0, -0.4), Vec3(0, 0, 0), Vec3(0.3, 0, 1e-9 - 1e-3), Vec3(0, 0, 0.04),
                        Vec3(0, 0.01, 0.03), Vec3(nan, 0, 0.4)}) {
    EXPECT_FALSE(feature.Compute(p, Vec3::Zero(), state)) << p.transpose();
  }
  EXPECT_FALSE(feature.Compute({0, 0, 0.4}, {0, nan, 0}, state));
  EXPECT_EQ(state.s[0], 7.0) << "untouched";

  Vec3 p;
  Mat3 cov;
  const Mat3 good = Mat3::Identity() * 1e-4;
  EXPECT_FALSE(feature.Lift({0, 0, -10}, good, p, cov));
  EXPECT_FALSE(feature.Lift({0, 0, 1.0}, good, p, cov));
  EXPECT_FALSE(feature.Lift({0, nan, 10}, good, p, cov));
  EXPECT_FALSE(feature.Lift({0, 0, 10}, good * nan, p, cov));

  Vec3 s;
  Mat3 ds_dm;
  for (const Vec3& m :
       {Vec3(0, 0, 1.0), Vec3(0, 0, 0.5), Vec3(0, 0, -1.1), Vec3(0, 0, 40.0), Vec3(nan, 0, 1.1)}) {
    EXPECT_FALSE(SphereFromCone(m, s, ds_dm)) << m.transpose();
  }
}

}  // namespace
}  // namespace fovea::features
