// SPDX-License-Identifier: Apache-2.0
// Commanded motions keep all limits: workspace, obstacles, speed, singularities.
#include <cmath>
#include <iostream>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "tests/core/moves/moved_arm.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::moves {
namespace {

using hal::HoldReason;

using MoveLimitsTest = FollowMotionTest;

// A motion to a goal outside the workspace starts, stops inside the workspace and is refused.
TEST_F(MoveLimitsTest, PathLeavingTheWorkspaceIsStoppedAndRefused) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.workspace_radius = 0.75;
  const model::VecN q = test::Ready();
  Start(config, q);
  ASSERT_LT(outermost_, 0.74);
  model::VecN goal = q;
  goal[1] += 0.5;
  goal[3] += 0.9;  // stretched out
  ASSERT_GT(PoseOf(goal).p.norm(), 0.76);
  Tick(JointGoal(goal));
  RunToHold();
  for (int i = 0; i < 1000; ++i) {
    Tick({});
  }
  std::cout << "reached " << outermost_ << " m of 0.75 m, " << hal::Name(record().hold_reason) << "\n";
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused);
  EXPECT_LT(outermost_, 0.751);
  EXPECT_GT((arm_->q() - q).norm(), 0.05) << "the motion starts";
  EXPECT_LE(most_, 1.0);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
}

// A hand commanded through a plane or into a box stops in front of it.
TEST_F(MoveLimitsTest, HandStopsBeforePlanesAndBoxes) {
  config::ServoConfig config = test::PandaConfig();
  config.move.pose_error_max = 0.2;  // the servo shall not give up soon
  const model::Vec3 p = PoseOf(test::Ready()).p;
  config::Obstacles plane;
  plane.num_planes = 1;
  plane.planes[0] = {model::Vec3::UnitZ(), p.z() - 0.10};
  config::Obstacles box;
  box.num_boxes = 1;
  box.boxes[0] = {p + model::Vec3(-0.15, -0.3, -0.4), p + model::Vec3(0.3, 0.3, -0.10)};
  for (const config::Obstacles& obstacles : {plane, box}) {
    config.guard.obstacles = obstacles;
    Start(config, test::Ready());
    hal::LimitSet limits = 0;
    double lowest = p.z();
    Tick(Pose(MotionKind::kPoseGoal, p - model::Vec3(0.0, 0.0, 0.25),
              model::RotationVector(PoseOf(arm_->q()).R)));
    int ticks = 0;
    while (record().mode == Mode::kMove) {
      limits |= Tick({}).limits_active;
      lowest = std::min(lowest, PoseOf(arm_->q()).p.z());
      ++ticks;
    }
    for (int i = 0; i < 500; ++i) {
      Tick({});
      lowest = std::min(lowest, PoseOf(arm_->q()).p.z());
    }
    std::cout << "stops " << 1e3 * (lowest - p.z() + 0.10) << " mm before it, given up after " << ticks
              << " ms\n";
    EXPECT_GT(lowest, p.z() - 0.10 - 1e-3);
    // The last link's capsule, which reaches 34 mm beyond the flange, keeps its clearance too.
    EXPECT_LT(lowest, p.z() - 0.10 + 0.034 + config.guard.link_clearance + 0.01)
        << "the hand must come close";
    EXPECT_NE(limits & hal::Bit(hal::Limit::kObstacle), 0U);
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused);
    EXPECT_EQ(record().fault, hal::Fault::kNone);
    EXPECT_LE(most_, 1.0);
  }
}

TEST_F(MoveLimitsTest, HandKeepsItsCartesianSpeedLimit) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.cartesian_speed = 0.15;
  Start(config, test::Ready());
  const model::Vec3 p = PoseOf(test::Ready()).p;
  const model::Vec3 phi = model::RotationVector(PoseOf(arm_->q()).R);
  hal::LimitSet limits = 0;
  double fastest = 0.0;
  model::Vec3 before = PoseOf(Reference()).p;
  for (int tick = 0; tick < 1500; ++tick) {
    const double t = 1e-3 * tick;
    const double y = 0.15 * (1.0 - std::cos(2.0 * t));  // 0.3 m/s at its fastest
    limits |= Tick(Pose(MotionKind::kPoseSetpoint, p + model::Vec3(0.0, y, 0.0), phi,
                        {0.0, 0.30 * std::sin(2.0 * t), 0.0}))
                  .limits_active;
    fastest = std::max(fastest, (PoseOf(Reference()).p - before).norm() / 1e-3);
    before = PoseOf(Reference()).p;
  }
  std::cout << "fastest " << fastest << " m/s of 0.15 m/s, " << hal::Name(record().hold_reason) << "\n";
  EXPECT_LT(fastest, 0.15 * 1.008);
  EXPECT_NE(limits & hal::Bit(hal::Limit::kCartesianSpeed), 0U);
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused)
      << "the hand cannot keep up, and the servo reports it";
}

// The plan to a joint goal keeps the hand's speed limits on the way, and the goal is reached.
TEST_F(MoveLimitsTest, JointGoalKeepsTheSpeedsOfTheHandAndArrives) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.cartesian_speed = 0.4;
  config.guard.rotation_speed = 0.9;
  config.guard.workspace_radius = 10.0;
  config.guard.self_clearance = 0.0;
  test::RandomStates random(51);
  double fastest = 0.0;
  double most_turn = 0.0;
  for (int goal = 0; goal < 40; ++goal) {
    Start(config, test::Ready());
    Tick(JointGoal(test::Ready() + random.Joints(config.arm, 0.6)));
    model::Pose before = PoseOf(Reference());
    for (int tick = 0; tick < 20'000 && record().mode == Mode::kMove; ++tick) {
      Tick({});
      const model::Pose now = PoseOf(Reference());
      fastest = std::max(fastest, (now.p - before.p).norm() / 1e-3);
      most_turn = std::max(most_turn, model::RotationVector(before.R.transpose() * now.R).norm() / 1e-3);
      before = now;
    }
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone) << hal::Name(record().hold_reason);
  }
  std::cout << "fastest " << fastest << " m/s of 0.4, " << most_turn << " rad/s of 0.9\n";
  EXPECT_LE(fastest, 0.4);
  EXPECT_LE(most_turn, 0.9);
  EXPECT_GT(std::max(fastest / 0.4, most_turn / 0.9), 0.75) << "the goals must be far";
}

// The hand is commanded far out in a workspace that allows it: the elbow does not become straight.
TEST_F(MoveLimitsTest, SingularPostureIsNotEntered) {
  config::ServoConfig config = test::PandaConfig();
  config.guard.workspace_radius = 2.0;
  config.guard.singularity_min = 0.06;
  config.move.pose_error_max = 1.0;  // the servo shall not give up soon
  Start(config, test::Ready());
  const model::Pose start = PoseOf(test::Ready());
  hal::LimitSet limits = 0;
  double least = HUGE_VAL;
  Tick(Pose(MotionKind::kPoseGoal, start.p + model::Vec3(0.5, 0.0, 0.1), model::RotationVector(start.R)));
  for (int i = 0; i < 4000; ++i) {
    limits |= Tick({}).limits_active;
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, arm_->q(), poses);
    model::Mat6N J;
    model::ComputeJacobian(config_.arm, poses, model::Pose{}, J);
    barriers::Singularity singularity;
    barriers::ComputeSingularity(J, barriers::SingularityConfig{}.length, singularity);
    least = std::min(least, singularity.sigma);
  }
  std::cout << "smallest singular value " << least << ", allowed 0.06\n";
  EXPECT_GT(least, 0.06 - 0.003);
  EXPECT_LT(least, 0.09) << "the arm must come close";
  EXPECT_NE(limits & hal::Bit(hal::Limit::kSingularity), 0U);
  EXPECT_LE(most_, 1.0);
  EXPECT_EQ(record().fault, hal::Fault::kNone);
}

// Between two motions something else may have moved the arm.
TEST_F(MoveLimitsTest, PauseResetsTheSingularityEstimate) {
  const model::Pose start = PoseOf(arm_->q());
  Tick(Pose(MotionKind::kPoseGoal, start.p + model::Vec3(0.0, 0.05, 0.0), model::RotationVector(start.R)));
  EXPECT_GT(task_.state().motion.resolved.watch.sigma, 0.0);
  RunToHold();
  EXPECT_EQ(task_.state().motion.resolved.watch.sigma, 0.0);
  EXPECT_EQ(task_.state().motion.resolved.dq.size(), 0);
}

}  // namespace
}  // namespace fovea::moves
