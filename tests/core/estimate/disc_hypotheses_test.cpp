// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/pose_hypotheses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace fovea::estimate {
namespace {

using model::Mat3;
using model::Pose;
using model::Vec3;

// The measurement of a disc 0.5 m below the base with normal `n`, from a camera at `p_BC` that looks at it.
// The false pose comes first.
hal::FeatureMeasurement See(const Vec3& n, const Vec3& p_BC, Pose& X_BC) {
  const Vec3 disc(0.0, 0.0, -0.5);
  const Vec3 ray = (disc - p_BC).normalized();
  const Eigen::Quaterniond look = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), ray);
  X_BC = {look.toRotationMatrix(), p_BC};
  hal::FeatureMeasurement m;
  m.kind = hal::FeatureKind::kCircle;
  m.found = true;
  m.num_poses = 2;
  const double depth = (disc - p_BC).norm();
  m.s = {0.0, 0.0, 0.08 / depth};
  m.cov_s[2 * hal::kMaxFeatureDim + 2] = std::pow(5e-4 * 0.08 / depth, 2);
  const Vec3 other = 2.0 * n.dot(ray) * ray - n;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3 normal_C = X_BC.R.transpose() * (i == 0 ? other : n);
    const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal_C);
    m.poses[i] = {{0.0, 0.0, depth}, {q.w(), q.x(), q.y(), q.z()}, 0};
  }
  return m;
}

const Vec3 kNormal = Vec3(0.4, 0.1, -1.0).normalized();

TEST(DiscHypothesesTest, CameraMotionSelectsTheTruePose) {
  PoseHypotheses hypotheses;
  int changes = 0;
  Pose X_BC;
  const hal::FeatureMeasurement first = See(kNormal, {0.0, 0.0, 0.0}, X_BC);
  EXPECT_EQ(TakeView(first, X_BC, hypotheses).pose, 0)
      << "one view does not decide: the detector's first pose counts";
  Verdict verdict;
  for (int i = 1; i <= 30; ++i) {
    const hal::FeatureMeasurement m = See(kNormal, {0.005 * i, -0.004 * i, 0.0}, X_BC);
    verdict = TakeView(m, X_BC, hypotheses);
    changes += verdict.changed ? 1 : 0;
  }
  EXPECT_EQ(verdict.pose, 1);
  EXPECT_EQ(changes, 1);
  EXPECT_EQ(hypotheses.disc.count, 1);
  EXPECT_EQ(hypotheses.disc.stillness, Stillness::kStill);
  EXPECT_LT((hypotheses.disc.best().normal_B - kNormal).norm(), 1e-9);
}

TEST(DiscHypothesesTest, FrontalViewKeepsTheKnownPose) {
  PoseHypotheses hypotheses;
  Pose X_BC;
  // The camera crosses the normal, where both poses coincide and swap.
  for (int i = 0; i <= 60; ++i) {
    const double along = 0.02 * i;
    const Vec3 p_BC = Vec3(0.0, 0.0, -0.5) - 0.5 * (kNormal + Vec3(0.0, 0.6 - along, 0.0)).normalized();
    const hal::FeatureMeasurement m = See(kNormal, p_BC, X_BC);
    const Verdict verdict = TakeView(m, X_BC, hypotheses);
    if (i > 20) {
      EXPECT_LT((hypotheses.disc.best().normal_B - kNormal).norm(), 0.02) << i;
      EXPECT_FALSE(verdict.changed) << i;
    }
  }
}

TEST(DiscHypothesesTest, TurningDiscIsFollowed) {
  PoseHypotheses hypotheses;
  Pose X_BC;
  for (int i = 0; i <= 90; ++i) {
    const double angle = 0.02 * i;  // 103 degrees in total about the vertical
    const Vec3 n = Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), -1.0).normalized();
    hal::FeatureMeasurement m = See(n, {0.1, 0.0, 0.0}, X_BC);
    std::swap(m.poses[0], m.poses[1]);  // the true pose first
    EXPECT_EQ(TakeView(m, X_BC, hypotheses).pose, 0) << i;
  }
}

TEST(DiscHypothesesTest, InvalidSecondPoseSelectsTheFirst) {
  PoseHypotheses hypotheses;
  Pose X_BC;
  hal::FeatureMeasurement m = See(kNormal, {0.0, 0.0, 0.0}, X_BC);
  m.poses[1].q_CO = {0.0, 0.0, 0.0, 0.0};
  const Verdict verdict = TakeView(m, X_BC, hypotheses);
  EXPECT_EQ(verdict.pose, 0);
  EXPECT_FALSE(verdict.changed);
  EXPECT_EQ(hypotheses.disc.count, 0);
}

}  // namespace
}  // namespace fovea::estimate
