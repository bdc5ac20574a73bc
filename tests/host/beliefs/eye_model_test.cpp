// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/eye_model.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "firmware/core/features/square.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/host/beliefs/refocus.hpp"
#include "tests/host/beliefs/synthetic_run.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::beliefs {
namespace {

// On the optical axis, the tangent of the outline's angle shrinks by the focal length's factor.
TEST(RefocusTest, OnTheAxisTheOutlineShrinks) {
  const model::Vec3 s_meas(0.0, 0.0, 6.0);
  model::Vec3 s;
  model::Vec3 ds;
  ASSERT_TRUE(RefocusSphere(s_meas, 0.03, s, ds));
  const double tangent = std::tan(std::asin(1.0 / 6.0)) / 1.03;
  EXPECT_NEAR(s.z(), 1.0 / std::sin(std::atan(tangent)), 1e-12);
  EXPECT_NEAR(s.head<2>().norm(), 0.0, 1e-12);
}

// A small sphere is a point: its direction in the image shrinks.
TEST(RefocusTest, ASmallSphereMovesLikeAPoint) {
  const model::Vec3 s_meas = 1e3 * model::Vec3(0.3, -0.2, 1.0);
  model::Vec3 s;
  model::Vec3 ds;
  ASSERT_TRUE(RefocusSphere(s_meas, 0.03, s, ds));
  EXPECT_NEAR(s.x() / s.z(), 0.3 / 1.03, 1e-6);
  EXPECT_NEAR(s.y() / s.z(), -0.2 / 1.03, 1e-6);
}

TEST(RefocusTest, DerivativeAgreesWithDifferences) {
  const model::Vec3 s_meas(1.5, -2.0, 6.0);
  constexpr double kStep = 1e-6;
  model::Vec3 s;
  model::Vec3 ds;
  model::Vec3 ignored;
  model::Vec3 above;
  model::Vec3 below;
  ASSERT_TRUE(RefocusSphere(s_meas, 0.02, s, ds));
  ASSERT_TRUE(RefocusSphere(s_meas, 0.02 + kStep, above, ignored));
  ASSERT_TRUE(RefocusSphere(s_meas, 0.02 - kStep, below, ignored));
  EXPECT_LE((ds - (above - below) / (2.0 * kStep)).norm(), 1e-7 * ds.norm());
}

// The whole Jacobian, by central differences, at a state that differs from the believed one in everything.
void ExpectJacobian(const config::ServoConfig& config, const model::Pose& X_BO) {
  const EyeLayout layout(config);
  JointTrack track;
  const test::Waves waves = test::LookAround();
  for (int tick = 0; tick < 600; ++tick) {
    track.Add(tick * hal::kTickPeriodNs, waves(1e-3 * tick).q);
  }
  EyeState state = Believed(config, X_BO);
  Eigen::VectorXd off = Eigen::VectorXd::Constant(layout.size(), 0.01);
  off[EyeLayout::kLate] = 0.0105;
  Apply(layout, off, state);
  EyePose eye;
  ASSERT_TRUE(PoseOfEye(config, track, state, 300 * hal::kTickPeriodNs, eye));
  test::TruthEye truth(config.feature, 554.0, 1.0, 1);
  const hal::FeatureMeasurement m = truth.See(eye.X_BC.Inverse() * X_BO, 300 * hal::kTickPeriodNs, 0);
  Equations here;
  ASSERT_TRUE(Compare(config, track, m, 0, state, here));
  double worst = 0.0;
  for (int i = 0; i < layout.size(); ++i) {
    const double step =
        i == EyeLayout::kLate ? 1e-4 : 1e-6;  // within a tick the readings are a straight line
    Equations side[2];
    for (int k = 0; k < 2; ++k) {
      EyeState moved = state;
      Apply(layout, Eigen::VectorXd::Unit(layout.size(), i) * (k == 0 ? -step : step), moved);
      ASSERT_TRUE(Compare(config, track, m, 0, moved, side[k]));
    }
    const Eigen::VectorXd difference = (side[1].residual - side[0].residual) / (2.0 * step);
    const double error = (here.jacobian.col(i) - difference).norm() / difference.norm();
    EXPECT_LE(error, i == EyeLayout::kLate ? 1e-3 : 1e-6) << "unknown " << i;
    EXPECT_GT(difference.norm(), 0.0) << "unknown " << i;
    worst = std::max(worst, error);
  }
  fmt::print("largest relative error of a column: {:.1e}\n", worst);
}

TEST(EyeModelTest, JacobianOfASphereAgreesWithDifferences) {
  ExpectJacobian(test::PandaConfig(), {model::Mat3::Identity(), test::BallPlace()});
}

TEST(EyeModelTest, JacobianOfASquareAgreesWithDifferences) {
  config::ServoConfig config = test::PandaConfig();
  config.feature.target = hal::FeatureKind::kSquare;
  config.feature.form = features::FeatureForm::kCorners;
  config.feature.corners.num_corners = 4;
  config.feature.corners.corners = {model::Vec3(-0.05, -0.05, 0.0), model::Vec3(0.05, -0.05, 0.0),
                                    model::Vec3(0.05, 0.05, 0.0), model::Vec3(-0.05, 0.05, 0.0)};
  ExpectJacobian(config, {model::RotationOf({model::kPi - 0.1, 0.1, 0.2}), test::BallPlace()});
}

}  // namespace
}  // namespace fovea::beliefs
