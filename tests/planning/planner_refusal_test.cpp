// SPDX-License-Identifier: Apache-2.0
// What the planner answers when there is no motion, or no sound request.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/planning/planner.hpp"
#include "tests/planning/starts.hpp"

namespace fovea {
namespace {

using planning::Planner;
using trajectory::Plan;
using trajectory::PlanOutcome;
using trajectory::PlanRequest;

// The Panda in its ready posture, with the target `p_CO_C` [m] in the camera, which it faces.
PlanRequest FromReady(const config::ServoConfig& config, const model::Vec3& p_CO_C) {
  const int n = config.arm.num_joints;
  PlanRequest request;
  request.start.q = model::ToVector(config.arm.q_ready, n);
  request.start.dq.setZero(n);
  request.start.ddq.setZero(n);
  model::ArmPoses poses;
  model::ComputePoses(config.arm, request.start.q, poses);
  request.X_BO = poses.X_BE * config.X_EC * model::Pose{model::Mat3::Identity(), p_CO_C};
  return request;
}

class PlannerRefusal : public testing::Test {
 protected:
  // The answer to `request` with the servo as it is.
  const Plan& Answer(const PlanRequest& request) {
    Planner(config_).Compute(request, plan_);
    EXPECT_TRUE(plan_.IsSound());
    EXPECT_EQ(plan_.num_points, plan_.IsFound() ? plan_.num_points : 0);
    return plan_;
  }
  PlanOutcome OutcomeOf(const PlanRequest& request) { return Answer(request).outcome; }

  config::ServoConfig config_ = test::PlannedServo("panda", "square");
  Plan plan_;
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const model::Vec3 kAhead(0.05, 0.02, 0.45);

TEST_F(PlannerRefusal, ASoundRequestIsAnswered) {
  EXPECT_EQ(OutcomeOf(FromReady(config_, kAhead)), PlanOutcome::kFound);
}

TEST_F(PlannerRefusal, ABadRequestIsNamed) {
  const PlanRequest sound = FromReady(config_, kAhead);
  const auto outcome = [&](auto change) {
    PlanRequest request = sound;
    change(request);
    return OutcomeOf(request);
  };
  EXPECT_EQ(outcome([](PlanRequest& r) { r.start.q[3] = kNan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.start.dq[0] = kNan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.start.ddq[6] = HUGE_VAL; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.X_BO.p.x() = kNan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.X_BO.R(1, 2) = kNan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.normal_B.z() = kNan; }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.start.q.conservativeResize(6); }), PlanOutcome::kBadRequest);
  EXPECT_EQ(outcome([](PlanRequest& r) { r.start.dq.resize(0); }), PlanOutcome::kBadRequest);
}

TEST_F(PlannerRefusal, AStartThatMovesIsNamed) {
  PlanRequest request = FromReady(config_, kAhead);
  request.start.dq[2] = 0.01;
  EXPECT_EQ(OutcomeOf(request), PlanOutcome::kStartMoves);
}

TEST_F(PlannerRefusal, AStartPastALimitIsNamedWithTheLimit) {
  PlanRequest request = FromReady(config_, kAhead);
  request.start.q[5] = config_.arm.joints[5].q_max + 0.01;
  EXPECT_EQ(Answer(request).outcome, PlanOutcome::kStartNotClear);
  EXPECT_EQ(plan_.blocker, hal::Limit::kJointPosition);

  config_.guard.workspace_radius = 0.3;
  EXPECT_EQ(Answer(FromReady(config_, kAhead)).outcome, PlanOutcome::kStartNotClear);
  EXPECT_EQ(plan_.blocker, hal::Limit::kWorkspace);

  config_ = test::PlannedServo("panda", "square");
  config_.guard.obstacles.planes[0].distance = 0.7;
  EXPECT_EQ(Answer(FromReady(config_, kAhead)).outcome, PlanOutcome::kStartNotClear);
  EXPECT_EQ(plan_.blocker, hal::Limit::kObstacle);
}

// Between the margin of the tick's resolution and that of the proof of a stop: the way leads back.
TEST_F(PlannerRefusal, AStartNearerThanTheMarginsIsNotRefused) {
  const PlanRequest request = FromReady(config_, {0.0, 0.0, 0.5});
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, request.start.q, poses);
  config_.guard.workspace_radius = poses.X_BE.p.norm() + config_.guard.workspace_margin + 1e-3;
  config_.guard.obstacles.num_planes = 0;
  EXPECT_EQ(OutcomeOf(request), PlanOutcome::kFound);
  config_.guard.workspace_radius -= 1.1e-3;
  EXPECT_EQ(OutcomeOf(request), PlanOutcome::kStartNotClear);
}

TEST_F(PlannerRefusal, ATargetThatIsNotSeenIsNamed) {
  EXPECT_EQ(OutcomeOf(FromReady(config_, {0.0, 0.0, -0.4})), PlanOutcome::kTargetNotInSight);
  EXPECT_EQ(OutcomeOf(FromReady(config_, {0.6, 0.0, 0.4})), PlanOutcome::kTargetNotInSight);
  PlanRequest from_behind = FromReady(config_, kAhead);
  from_behind.X_BO.R = from_behind.X_BO.R * model::RotationOf({model::kPi, 0.0, 0.0});
  EXPECT_EQ(OutcomeOf(from_behind), PlanOutcome::kTargetNotInSight);
}

TEST_F(PlannerRefusal, AGoalOutOfReachIsNamed) {
  EXPECT_EQ(OutcomeOf(FromReady(config_, {0.0, 0.0, 3.0})), PlanOutcome::kNoGoalPosture);
}

TEST_F(PlannerRefusal, AGoalPastALimitIsNamedWithTheLimit) {
  config_.feature.p_CO_C_star = {0.0, 0.0, 0.20};
  config_.guard.obstacles.planes[0].distance = 0.35;  // the camera would have to go below it
  EXPECT_EQ(Answer(FromReady(config_, {0.0, 0.0, 0.5})).outcome, PlanOutcome::kGoalNotClear);
  EXPECT_EQ(plan_.blocker, hal::Limit::kObstacle);
}

// The lines of sight at the goal pass the box nearer than those of a plan do if they can.
TEST_F(PlannerRefusal, AGoalWithABoxBesideTheTargetIsPlannedTo) {
  config_.feature.p_CO_C_star = {0.0, 0.0, 0.30};
  PlanRequest request = FromReady(config_, {0.03, 0.02, 0.60});
  const double half_side = config_.feature.Outline().p_OP[0].x();
  const model::Vec3 beside = request.X_BO.p + model::Vec3(std::fabs(half_side) + 0.02, 0.0, 0.0);
  config_.guard.obstacles.num_boxes = 1;
  config_.guard.obstacles.boxes[0] = {beside - model::Vec3(0.0, 0.08, 0.04),
                                      beside + model::Vec3(0.05, 0.08, 0.01)};
  EXPECT_TRUE(Answer(request).IsFound())
      << trajectory::kPlanOutcomeWords[static_cast<std::size_t>(plan_.outcome)];
  trajectory::Reference end;
  plan_.At(plan_.Duration(), end);
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, end.q, poses);
  const double room =
      barriers::ClearanceOfSight({poses, barriers::PlaceBodies(config_.arm, poses), poses.X_BE * config_.X_EC,
                                  config_.feature.Outline(), request.X_BO, config_.guard.obstacles}) -
      config_.guard.sight_clearance;
  std::cout << "lines of sight keep " << 1e3 * room << " mm more than safety.sight_clearance\n";
  EXPECT_GT(room, 0.003 - 1e-6);
  EXPECT_LT(room, 0.025) << "a plan with the usual room would do";
}

// A wall or a beam beside the hand, which has to get to its other side.
class PlannerBehindABox : public PlannerRefusal {
 protected:
  PlanOutcome Behind(double low, double high, int budget) {
    config_.guard.obstacles.num_boxes = 1;
    config_.guard.obstacles.boxes[0] = {{-2.0, 0.10, low}, {2.0, 0.14, high}};
    config_.guard.view.enabled = false;
    config_.guard.sight_clearance = 0.0;
    PlanRequest request = FromReady(config_, kAhead);
    request.X_BO.p.y() += 0.24;
    request.budget = budget;
    return Answer(request).outcome;
  }
};

TEST_F(PlannerBehindABox, AWallWithoutAWayAroundItIsNamed) {
  EXPECT_EQ(Behind(-2.0, 2.0, 60'000), PlanOutcome::kGoalNotClear);  // the arm itself would be in the wall
  EXPECT_EQ(plan_.blocker, hal::Limit::kObstacle);
}

TEST_F(PlannerBehindABox, ABudgetThatEndsBeforeTheWayIsFoundIsNamed) {
  EXPECT_EQ(Behind(0.4, 0.6, 20'000), PlanOutcome::kNoPath);
  EXPECT_EQ(Behind(0.4, 0.6, 60'000), PlanOutcome::kFound);
  EXPECT_EQ(Behind(-2.0, 0.4, 5'000), PlanOutcome::kFound) << "over a lower wall";
}

TEST_F(PlannerRefusal, AFeatureThatLeavesTheGoalOpenIsNamed) {
  config_.feature.form = features::FeatureForm::kSide;
  EXPECT_EQ(OutcomeOf(FromReady(config_, kAhead)), PlanOutcome::kNotPlanned);
}

}  // namespace
}  // namespace fovea
