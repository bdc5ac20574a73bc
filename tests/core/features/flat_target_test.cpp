// SPDX-License-Identifier: Apache-2.0
// Square and triangle: every form of their features against finite differences, refused input, the list.
#include <gtest/gtest.h>

#include <iostream>
#include <set>
#include <utility>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/math.hpp"
#include "tests/core/features/camera_steps.hpp"

namespace fovea::features {
namespace {

using hal::FeatureKind;
using model::Vec3;

TargetFeature Make(FeatureKind target, FeatureForm form) {
  TargetFeature feature;
  feature.target = target;
  feature.form = form;
  feature.corners =
      TraitsOf(target).num_corners == 3 ? MakeTriangle(kDefaultTriangle) : MakeSquare(feature.side);
  return feature;
}

// Every target with each of its feature forms.
std::set<std::pair<FeatureKind, FeatureForm>> Listed() {
  std::set<std::pair<FeatureKind, FeatureForm>> listed;
  for (const TargetTraits& target : kTargets) {
    for (const FeatureForm form : target.forms) {
      listed.emplace(target.kind, form);
    }
  }
  return listed;
}

// This includes the target's own motion: RandomView gives the target a velocity and a turn rate.
TEST(FlatTargetTest, EveryInteractionMatrixMatchesFiniteDifferences) {
  for (const auto& [target, form] : Listed()) {
    const double worst = test::WorstDerivative(Make(target, form), 0.6, 43, 1000);
    std::cout << kTargetNames[static_cast<std::size_t>(target)] << ", "
              << kFormNames[static_cast<std::size_t>(form)] << ": worst relative difference over 1000 poses "
              << worst << "\n";
    EXPECT_LT(worst, 1e-8);
  }
}

TEST(FlatTargetTest, ListedFeaturesAreCompleteWithTheirDimensions) {
  int listed = 0;
  for (std::size_t target = 0; target < kTargetNames.size(); ++target) {
    for (std::size_t form = 0; form < kFormNames.size(); ++form) {
      TargetFeature feature = Make(static_cast<FeatureKind>(target), static_cast<FeatureForm>(form));
      if (!feature.IsListed()) {
        continue;
      }
      ++listed;
      FeatureState state;
      ASSERT_TRUE(feature.ComputeAtGoal(state));
      EXPECT_EQ(state.s.size(), feature.Dim());
      EXPECT_EQ(state.L_s.rows(), feature.Dim());
      EXPECT_LT((state.s - state.s_star).norm(), 1e-15) << "the error at the goal is zero";
      EXPECT_TRUE(state.ds_dt_target.isZero());
      feature.hold_orientation = true;
      EXPECT_EQ(feature.IsListed(), state.s.size() + 3 <= kMaxDim);
    }
  }
  EXPECT_EQ(listed, static_cast<int>(Listed().size()));
}

// A frontal view from above, with values that are easy to check by hand.
TEST(SquareFeatureTest, FourEntriesMatchHandComputedValues) {
  SquareSideFeature feature;
  TargetInCamera seen;
  seen.X_CO.p = {0.02, -0.01, 0.5};
  const double turn = 0.3;
  seen.X_CO.R = test::Turned({0, 0, turn});
  FeatureState state;
  ASSERT_TRUE(feature.Compute(seen, state));
  EXPECT_NEAR(state.s[0], 0.04, 1e-15);
  EXPECT_NEAR(state.s[1], -0.02, 1e-15);
  EXPECT_NEAR(state.s[2], turn, 1e-15);
  EXPECT_NEAR(state.s[3], 0.2, 1e-15);
  feature.anchor = SquareSideFeature::Anchor::kFirstCorner;
  ASSERT_TRUE(feature.Compute(seen, state));
  const Vec3 corner = seen.X_CO * Vec3(-0.05, -0.05, 0.0);
  EXPECT_NEAR(state.s[0], corner.x() / corner.z(), 1e-15);
  EXPECT_NEAR(state.s[1], corner.y() / corner.z(), 1e-15);
}

TEST(SquareFeatureTest, AngleErrorStaysWithinHalfATurn) {
  SquareSideFeature feature;
  feature.X_CO_star.R = test::Turned({0, 0, 3.0});
  TargetInCamera seen;
  seen.X_CO = {test::Turned({0, 0, -3.0}), {0, 0, 0.4}};
  FeatureState state;
  ASSERT_TRUE(feature.Compute(seen, state));
  EXPECT_NEAR(state.s_star[2] - state.s[2], 6.0 - 2.0 * model::kPi, 1e-12);
}

TEST(FlatTargetTest, RefusesATargetNotFullyInFrontOfTheCamera) {
  const double nan = std::nan("");
  for (const auto& [target, form] : Listed()) {
    const TargetFeature feature = Make(target, form);
    FeatureState state;
    state.s = FeatureVector::Constant(3, 7.0);
    TargetInCamera seen;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0, 0, -0.4), Vec3(0, 0, 0.005), Vec3(nan, 0, 0.4)}) {
      seen.X_CO.p = p;
      EXPECT_FALSE(feature.Compute(seen, state)) << p.transpose();
    }
    seen.X_CO.p = {0, 0, 0.4};
    seen.v_BO_C = {nan, 0, 0};
    EXPECT_FALSE(feature.Compute(seen, state));
    EXPECT_EQ(state.s[0], 7.0) << "untouched";
  }
  // A corner is behind the camera, the centre in front of it.
  TargetFeature square = Make(FeatureKind::kSquare, FeatureForm::kCorners);
  FeatureState state;
  TargetInCamera edge_on;
  edge_on.X_CO = {test::Turned({model::kPi / 2, 0, 0}), {0, 0, 0.04}};
  EXPECT_FALSE(square.Compute(edge_on, state));
  // The side whose angle is measured lies along the line of sight.
  edge_on.X_CO = {test::Turned({0, model::kPi / 2, 0}) * test::Turned({0, 0, 0}), {0, 0, 0.4}};
  square.form = FeatureForm::kCornerSide;
  edge_on.X_CO.p = -(edge_on.X_CO.R * Vec3(0, -0.05, 0)) + Vec3(0, 0, 0.4);
  EXPECT_FALSE(square.Compute(edge_on, state)) << "the angle is undefined";
}

TEST(FlatTargetTest, TakesCornersAndDropsInvalidPoses) {
  const TargetFeature feature = Make(FeatureKind::kTriangle, FeatureForm::kPose);
  hal::FeatureMeasurement m;
  m.found = true;
  m.kind = FeatureKind::kTriangle;
  m.dim = 6;
  for (std::size_t i = 0; i < 6; ++i) {
    m.s[i] = 0.1 * static_cast<double>(i);
    m.cov_s[i * hal::kMaxFeatureDim + i] = 1e-6 * static_cast<double>(i + 1);
  }
  const Eigen::Quaterniond q(test::Turned({0.1, -0.2, 0.3}));
  const std::array<double, 4> turned{q.w(), q.x(), q.y(), q.z()};
  m.num_poses = 5;
  m.poses[0] = {{0.0, 0.0, 0.5}, {0.0, 0.0, 0.0, 0.0}, 0};  // no orientation
  m.poses[1] = {{0.01, 0.02, 0.5}, turned, 2};
  m.poses[2] = {{0.01, 0.02, -0.5}, turned, 0};  // behind
  m.poses[3] = {{0.01, 0.02, 0.6}, turned, 3};   // no such corner
  m.poses[4] = {{0.01, 0.02, 0.7}, turned, 1};
  SeenCorners seen;
  ASSERT_TRUE(feature.TakeCorners(m, seen));
  ASSERT_EQ(seen.xy.size(), 6);
  EXPECT_EQ(seen.xy[5], m.s[5]);
  EXPECT_EQ(seen.cov(3, 3), 4e-6);
  EXPECT_EQ(seen.cov(3, 4), 0.0);
  ASSERT_EQ(seen.num_branches, 2);
  EXPECT_LT((seen.branches[0].X_CO.R - q.toRotationMatrix()).norm(), 1e-15);
  EXPECT_EQ(seen.branches[0].X_CO.p, Vec3(0.01, 0.02, 0.5));
  EXPECT_EQ(seen.branches[0].first, 2);
  EXPECT_EQ(seen.branches[1].X_CO.p.z(), 0.7);

  m.kind = FeatureKind::kSquare;
  EXPECT_FALSE(feature.TakeCorners(m, seen)) << "another target";
  m.kind = FeatureKind::kTriangle;
  m.dim = 8;
  EXPECT_FALSE(feature.TakeCorners(m, seen)) << "another number of corners";
  m.dim = 6;
  m.s[3] = std::nan("");
  EXPECT_FALSE(feature.TakeCorners(m, seen));
  LiftedTarget lifted;
  EXPECT_FALSE(feature.Lift(m, lifted)) << "corners give no position directly";
}

}  // namespace
}  // namespace fovea::features
