// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/equal_turn.hpp"

#include <gtest/gtest.h>

#include "firmware/core/model/rotation.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::features {
namespace {

TEST(EqualTurnTest, EqualTurnsMakeAFullTurn) {
  for (int turns = 1; turns <= 4; ++turns) {
    model::Mat3 R = model::Mat3::Identity();
    for (int turn = 0; turn < turns; ++turn) {
      EXPECT_LT((EqualTurn(turn, turns) - R).norm(), 3e-15) << turn << " of " << turns;
      R = R * EqualTurn(1, turns);
    }
    EXPECT_LT((R - model::Mat3::Identity()).norm(), 3e-15) << turns;
    EXPECT_EQ(EqualTurn(1, turns).row(2), EqualTurn(0, turns).row(2)) << "about z";
  }
  EXPECT_EQ(EqualTurn(1, 4)(1, 0), 1.0) << "counter-clockwise, and exact";
  EXPECT_EQ(EqualTurn(1, 4)(0, 0), 0.0);
}

// The nearest of all turns of the target, compared as angles.
TEST(EqualTurnTest, NearestTurnHasTheSmallestAngle) {
  test::RandomStates random(8);
  TargetFeature feature;
  for (const hal::FeatureKind kind :
       {hal::FeatureKind::kSphere, hal::FeatureKind::kSquare, hal::FeatureKind::kTriangle}) {
    feature.target = kind;
    const int turns = TraitsOf(kind).turns;
    int others = 0;
    for (int k = 0; k < 500; ++k) {
      feature.R_CO_star = model::RotationOf(random.Vector(2.0));
      const model::Mat3 R_CO = model::RotationOf(random.Vector(2.0));
      const int nearest = NearestTurn(feature, R_CO);
      ASSERT_GE(nearest, 0);
      ASSERT_LT(nearest, turns);
      others += nearest != 0 ? 1 : 0;
      const auto angle = [&](int turn) {
        return model::RotationVector(feature.R_CO_star.transpose() * R_CO * EqualTurn(turn, turns)).norm();
      };
      for (int turn = 0; turn < turns; ++turn) {
        EXPECT_LE(angle(nearest), angle(turn) + 1e-7);
      }
    }
    EXPECT_EQ(others > 0, turns > 1);
  }
}

}  // namespace
}  // namespace fovea::features
