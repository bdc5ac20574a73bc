// SPDX-License-Identifier: Apache-2.0
// The held orientation against finite differences, and stacked below a sphere.
#include "firmware/core/features/hold_orientation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <iostream>

#include "firmware/core/features/sphere.hpp"
#include "tests/core/features/camera_steps.hpp"

namespace fovea::features {
namespace {

TEST(HoldOrientationTest, InteractionMatrixMatchesFiniteDifferences) {
  test::RandomStates random(44);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const HoldOrientation feature{test::Turned(random.Vector(3.0))};
    const model::Mat3 R_BC = feature.R_BD * test::Turned(random.Vector(1.4));  // less than half a turn
    const model::Vec6 V = test::RandomTwist(random);
    constexpr double kDt = 1e-5;
    FeatureState now, plus, minus;
    ASSERT_TRUE(feature.Compute(R_BC, now));
    ASSERT_TRUE(feature.Compute(R_BC * test::Turned(kDt * V.tail<3>()), plus));
    ASSERT_TRUE(feature.Compute(R_BC * test::Turned(-kDt * V.tail<3>()), minus));
    const model::Vec3 difference = (plus.s - minus.s) / (2.0 * kDt);
    worst = std::max(worst, (now.L_s * V - difference).norm() / std::max(1.0, difference.norm()));
  }
  std::cout << "worst relative difference over 1000 orientations: " << worst << "\n";
  EXPECT_LT(worst, 1e-8);
}

TEST(HoldOrientationTest, StackedBelowASphereControlsSixDegreesOfFreedom) {
  FeatureState state;
  ASSERT_TRUE(SphereFeature{}.Compute({0.05, 0.02, 0.5}, {0.1, 0.0, 0.0}, state));
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(state.L_s).rank(), 3);
  FeatureState held;
  ASSERT_TRUE(HoldOrientation{}.Compute(test::Turned({0.1, 0.2, -0.1}), held));
  const FeatureState sphere = state;
  ASSERT_TRUE(Stack(held, state));
  ASSERT_EQ(state.s.size(), 6);
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(state.L_s).rank(), 6);
  EXPECT_EQ(state.s.head(3), sphere.s);
  EXPECT_EQ(state.s.tail(3), held.s);
  EXPECT_EQ(state.s_star.head(3), sphere.s_star);
  EXPECT_EQ(state.ds_dt_target.head(3), sphere.ds_dt_target);
  EXPECT_EQ(state.L_s.topRows(3), sphere.L_s);
  EXPECT_EQ(state.L_s.bottomRows(3), held.L_s);
  EXPECT_FALSE(Stack(held, state)) << "nine entries do not fit";
  EXPECT_EQ(state.s.size(), 6);
}

TEST(HoldOrientationTest, RefusesANonFiniteOrientation) {
  FeatureState state;
  EXPECT_FALSE(HoldOrientation{}.Compute(model::Mat3::Identity() * std::nan(""), state));
}

}  // namespace
}  // namespace fovea::features
