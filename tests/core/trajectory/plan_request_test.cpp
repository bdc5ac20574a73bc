// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/plan_request.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/core/features/square.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"

namespace fovea::trajectory {
namespace {

TEST(PlanRequestTest, HoldsWhatTheRecordSays) {
  hal::TickRecord record;
  record.stamp_ns = 123'456'789;
  record.command.num_joints = 7;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto x = static_cast<double>(i);
    record.q_cmd[i] = 0.1 * x;
    record.dq_cmd[i] = 1.0 + x;
    record.ddq_cmd[i] = 2.0 - x;
  }
  const model::Mat3 R_BO = model::RotationOf(model::Vec3(0.3, -0.7, 1.1));
  record.p_BO = {0.4, 0.5, -0.6};
  record.q_BO = model::QuaternionOf(R_BO);
  record.way.normal_B = {0.0, 0.6, 0.8};
  record.way.way = hal::Way::kAwaitPlan;
  record.way.plans_asked = 9;
  record.way.tries = 1;
  const PlanRequest request = RequestOf(record);
  ASSERT_EQ(request.start.q.size(), 7);
  EXPECT_EQ(request.start.q[3], record.q_cmd[3]);
  EXPECT_EQ(request.start.dq[6], 7.0);
  EXPECT_EQ(request.start.ddq[6], -4.0);
  EXPECT_EQ(request.X_BO.p, model::Vec3(0.4, 0.5, -0.6));
  EXPECT_LT((request.X_BO.R - R_BO).norm(), 1e-12);
  EXPECT_EQ(request.normal_B, model::Vec3(0.0, 0.6, 0.8));
  EXPECT_EQ(request.stamp_ns, 123'456'789);
  EXPECT_EQ(request.seed, 9U);
  EXPECT_EQ(request.kind, PlanRequest::Kind::kPlan);
}

TEST(PlanRequestTest, LawThatSteersAsksForAHorizon) {
  hal::TickRecord record;
  record.command.num_joints = 7;
  record.way.way = hal::Way::kLaw;
  record.q_cmd[2] = 0.5;
  record.arm.q[2] = 0.53;
  record.v_BO = {0.1, 0.0, -0.2};
  const PlanRequest request = RequestOf(record);
  EXPECT_EQ(request.kind, PlanRequest::Kind::kHorizon);
  EXPECT_EQ(request.v_BO, model::Vec3(0.1, 0.0, -0.2));
  ASSERT_EQ(request.q_off.size(), 7);
  EXPECT_NEAR(request.q_off[2], 0.03, 1e-12);
  EXPECT_EQ(request.q_off[0], 0.0);
}

TEST(PlanRequestTest, LaterTriesMayWorkMoreButNotWithoutEnd) {
  hal::TickRecord record;
  record.command.num_joints = 7;
  std::int64_t before = 0;
  for (const int tries : {-5, 0, 1}) {
    record.way.tries = tries;
    EXPECT_EQ(RequestOf(record).budget, RequestOf(hal::TickRecord{}).budget);
  }
  for (int tries = 1; tries < 3; ++tries) {
    record.way.tries = tries;
    EXPECT_GT(RequestOf(record).budget, before);
    before = RequestOf(record).budget;
  }
  record.way.tries = 1'000'000;
  EXPECT_LE(RequestOf(record).budget, 10 * RequestOf(hal::TickRecord{}).budget);
}

TEST(PlanRequestTest, OnlyAFeatureWithADefinedGoalIsPlannedFor) {
  config::ServoConfig config = test::PandaConfig();
  EXPECT_TRUE(IsPlannable(config));
  config.feature.hold_orientation = true;
  EXPECT_FALSE(IsPlannable(config)) << "a ball with a held orientation";
  config.feature.hold_orientation = false;
  config.feature.target = hal::FeatureKind::kSquare;
  config.feature.corners = features::MakeSquare(config.feature.side);
  using features::FeatureForm;
  for (const FeatureForm form : {FeatureForm::kCorners, FeatureForm::kPose}) {
    config.feature.form = form;
    EXPECT_TRUE(IsPlannable(config));
  }
  for (const FeatureForm form : {FeatureForm::kSide, FeatureForm::kCornerSide}) {
    config.feature.form = form;
    EXPECT_FALSE(IsPlannable(config)) << "it leaves a part of the pose free";
  }
  config.feature.form = FeatureForm::kPose;
  config.arm.num_joints = 5;
  EXPECT_FALSE(IsPlannable(config));
}

}  // namespace
}  // namespace fovea::trajectory
