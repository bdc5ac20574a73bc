// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/goal_posture.hpp"

#include <gtest/gtest.h>

#include "firmware/core/features/square.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"

namespace fovea::control {
namespace {

using model::Pose;
using model::VecN;

config::ServoConfig Config(hal::FeatureKind kind) {
  config::ServoConfig config = test::PandaConfig();
  config.feature.target = kind;
  config.feature.form = features::FeatureForm::kPose;
  config.feature.corners = kind == hal::FeatureKind::kSquare
                               ? features::MakeSquare(0.08)
                               : features::MakeTriangle(features::kDefaultTriangle);
  return config;
}

Pose CameraAt(const config::ServoConfig& config, const VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses.X_BE * config.X_EC;
}

// The pose of the target if the camera at `q` is at its goal.
Pose TargetFor(const config::ServoConfig& config, const VecN& q) {
  return CameraAt(config, q) * Pose{config.feature.R_CO_star, config.feature.p_CO_C_star};
}

int StepsUntilFound(const config::ServoConfig& config, const Pose& X_BO, const VecN& q, GoalPosture& goal) {
  for (int step = 1; step <= 20000; ++step) {
    SeekGoalPosture(config, X_BO, q, goal);
    if (goal.found) {
      return step;
    }
  }
  return 0;
}

void ExpectAtGoal(const config::ServoConfig& config, const Pose& X_BO, const GoalPosture& goal) {
  const Pose X_CO = CameraAt(config, goal.q).Inverse() * X_BO;
  EXPECT_LT((X_CO.p - config.feature.p_CO_C_star).norm(), 1e-3);
  EXPECT_LT(model::RotationVector(config.feature.R_CO_star.transpose() * X_CO.R *
                                  EqualTurn(goal.turn, features::TraitsOf(config.feature.target).turns))
                .norm(),
            1e-3);
  for (int i = 0; i < goal.q.size(); ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    EXPECT_GT(goal.q[i], joint.q_min + config.guard.joint_position_margin) << i;
    EXPECT_LT(goal.q[i], joint.q_max - config.guard.joint_position_margin) << i;
  }
}

TEST(GoalPostureTest, NearbyGoalIsFoundDownhillAndFollowsTheTarget) {
  const config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  q_goal[5] -= 0.2;
  Pose X_BO = TargetFor(config, q_goal);
  GoalPosture goal;
  EXPECT_GT(StepsUntilFound(config, X_BO, test::Ready(), goal), 0);
  EXPECT_TRUE(goal.downhill);
  for (int i = 0; i < 50; ++i) {
    X_BO.p.x() += 1e-3;
    SeekGoalPosture(config, X_BO, test::Ready(), goal);
  }
  SeekGoalPosture(config, X_BO, test::Ready(), goal);
  EXPECT_TRUE(goal.found);
  ExpectAtGoal(config, X_BO, goal);
}

// The last joint is at its upper end, the goal a third of a turn further: this needs the long way round.
TEST(GoalPostureTest, GoalBeyondAJointEndIsReachedTheOtherWayRound) {
  const config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  VecN q = test::Ready();
  q[6] = config.arm.joints[6].q_max - 0.1;
  VecN q_goal = q;
  q_goal[6] = q[6] + 2.0 - 2.0 * model::kPi;
  const Pose X_BO = TargetFor(config, q_goal);
  GoalPosture goal;
  ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
  EXPECT_FALSE(goal.downhill);
  SeekGoalPosture(config, X_BO, q, goal);
  SeekGoalPosture(config, X_BO, q, goal);
  ExpectAtGoal(config, X_BO, goal);
}

// A posture without a clear path is taken only after all rounds of the search find no other.
TEST(GoalPostureTest, PostureWithABlockedPathIsTakenLast) {
  config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  VecN q = test::Ready();
  q[6] = config.arm.joints[6].q_max - 0.1;
  VecN q_goal = q;
  q_goal[6] = q[6] + 2.0 - 2.0 * model::kPi;
  const Pose X_BO = TargetFor(config, q_goal);
  GoalPosture clear;
  const int steps = StepsUntilFound(config, X_BO, q, clear);
  ASSERT_GT(steps, 0);
  EXPECT_TRUE(clear.clear);
  config.guard.view = {true, 0.4, 0.5, 0.3, 0.4};  // the goal itself is outside
  GoalPosture barred;
  EXPECT_GT(StepsUntilFound(config, X_BO, q, barred), 5 * steps);
  EXPECT_TRUE(barred.found);
  EXPECT_FALSE(barred.clear);
}

TEST(GoalPostureTest, EqualTurnsMakeAFullTurn) {
  for (int turns = 1; turns <= 4; ++turns) {
    model::Mat3 R = model::Mat3::Identity();
    for (int turn = 0; turn < turns; ++turn) {
      EXPECT_LT((EqualTurn(turn, turns) - R).norm(), 3e-15) << turn << " of " << turns;
      R = R * EqualTurn(1, turns);
    }
    EXPECT_LT((R - model::Mat3::Identity()).norm(), 3e-15) << turns;
  }
  EXPECT_EQ(EqualTurn(1, 2), EqualTurn(2, 4)) << "exact";
}

// The hand is beside the camera. Half a turn would move the hand out of the workspace, in which it is now.
TEST(GoalPostureTest, SquareIsFacedFromASideInReach) {
  const config::ServoConfig config = Config(hal::FeatureKind::kSquare);
  const Pose half{EqualTurn(2, 4), model::Vec3::Zero()};
  const auto hand_turned = [&](const VecN& q) {
    return (CameraAt(config, q) * half * config.X_EC.Inverse()).p.norm();
  };
  VecN q = test::Ready();
  for (int i = 0; i < 100 && hand_turned(q) < config.guard.workspace_radius + 0.01; ++i) {
    q[3] += 0.015;  // stretches the arm
    q[5] -= 0.005;
  }
  ASSERT_GT(hand_turned(q), config.guard.workspace_radius);
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  ASSERT_LT(poses.X_BE.p.norm(), config.guard.workspace_radius - 0.01);
  const Pose X_BO = TargetFor(config, q) * half;
  GoalPosture goal;
  ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
  SeekGoalPosture(config, X_BO, q, goal);
  SeekGoalPosture(config, X_BO, q, goal);
  EXPECT_NE(goal.turn, 0);
  ExpectAtGoal(config, X_BO, goal);
}

// When the target jumps and a new posture search begins, the search tries the same side first.
TEST(GoalPostureTest, JumpingSquareKeepsItsGoalSide) {
  const config::ServoConfig config = Config(hal::FeatureKind::kSquare);
  const VecN q = test::Ready();
  Pose X_BO = TargetFor(config, q) * Pose{EqualTurn(3, 4), model::Vec3::Zero()};
  GoalPosture goal;
  goal.turn = 1;
  ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
  ASSERT_EQ(goal.turn, 1);
  VecN q_after = q;
  q_after[0] += 0.9;
  X_BO = TargetFor(config, q_after) * Pose{EqualTurn(3, 4), model::Vec3::Zero()};
  const std::uint32_t random = goal.random;
  SeekGoalPosture(config, X_BO, q, goal);
  ASSERT_FALSE(goal.found) << "lost";
  EXPECT_EQ(goal.turn, 1);
  EXPECT_EQ(goal.random, random);
  ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
  EXPECT_EQ(goal.turn, 1);
  SeekGoalPosture(config, X_BO, q, goal);
  SeekGoalPosture(config, X_BO, q, goal);
  ExpectAtGoal(config, X_BO, goal);
}

TEST(GoalPostureTest, RefusesPosturesBelowAPlaneOccludingOrSingular) {
  const config::ServoConfig free = Config(hal::FeatureKind::kTriangle);
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  const Pose X_BO = TargetFor(free, q_goal);
  model::ArmPoses poses;
  model::ComputePoses(free.arm, q_goal, poses);

  config::ServoConfig below = free;
  below.guard.obstacles.num_planes = 1;
  below.guard.obstacles.planes[0] = {{0.0, 0.0, 1.0}, poses.X_BE.p.z() + 0.01};
  GoalPosture goal;
  EXPECT_EQ(StepsUntilFound(below, X_BO, test::Ready(), goal), 0);
  below.guard.obstacles.planes[0].distance -= 0.15;  // the last link's radius is clear, too
  goal = GoalPosture{};
  EXPECT_GT(StepsUntilFound(below, X_BO, test::Ready(), goal), 0);

  config::ServoConfig hidden = free;
  hidden.guard.sight_clearance = 10.0;  // no posture has so much clearance
  goal = GoalPosture{};
  EXPECT_EQ(StepsUntilFound(hidden, X_BO, test::Ready(), goal), 0);

  config::ServoConfig singular = free;
  singular.guard.singularity_min = 1.0;  // no posture is so far from every singularity
  goal = GoalPosture{};
  EXPECT_EQ(StepsUntilFound(singular, X_BO, test::Ready(), goal), 0);
}

// If the margins leave no room in the range of a joint, the search uses its middle.
TEST(GoalPostureTest, JointWithANarrowRangeStaysInItsMiddle) {
  config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  VecN q_goal = test::Ready();
  config.arm.joints[2].q_min = q_goal[2] - 0.05;
  config.arm.joints[2].q_max = q_goal[2] + 0.05;
  q_goal[0] += 0.3;
  const Pose X_BO = TargetFor(config, q_goal);
  VecN q = test::Ready();
  q[2] += 0.03;
  GoalPosture goal;
  ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
  EXPECT_NEAR(goal.q[2], test::Ready()[2], 1e-12);
}

TEST(GoalPostureTest, FindsNoPostureForAGoalOutsideTheWorkspace) {
  const config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  Pose X_BO = TargetFor(config, test::Ready());
  X_BO.p.x() += 1.0;
  GoalPosture goal;
  EXPECT_EQ(StepsUntilFound(config, X_BO, test::Ready(), goal), 0);
}

// A start from `fovea atlas`: straight paths to all postures leave the picture or pass behind the arm.
TEST(GoalPostureTest, BlockedStraightPathsGiveADetourPosture) {
  config::ServoConfig config = Config(hal::FeatureKind::kTriangle);
  config.guard.view = {true, -0.55, 0.55, -0.41, 0.41};
  VecN q(7);
  q << -2.5214, -1.0664, 0.1162, -2.5597, -0.4828, 0.3145, -0.6362;
  const Pose X_BO{model::RotationOf({0.0, 0.0, -0.8262}) * model::RotationOf({0.0, 0.8165, 0.0}) *
                      model::RotationOf({-2.0721, 0.0, 0.0}),
                  {0.3949, 0.6875, 0.3594}};
  int detours = 0;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    GoalPosture goal;
    goal.random = seed;
    ASSERT_GT(StepsUntilFound(config, X_BO, q, goal), 0);
    EXPECT_TRUE(goal.clear);
    detours += goal.detour;
    const VecN second = goal.detour > 0 ? goal.q_via : q;
    WayTrial way;
    way.q = second;
    while (StepOnWay(config, X_BO, goal.q, way)) {
    }
    EXPECT_FALSE(way.barred) << "the straight path from there is clear, seed " << seed;
  }
  EXPECT_GE(detours, 2) << "this start must need detours";
}

}  // namespace
}  // namespace fovea::control
