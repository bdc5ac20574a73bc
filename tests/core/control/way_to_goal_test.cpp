// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/way_to_goal.hpp"

#include <gtest/gtest.h>

#include "firmware/core/features/triangle.hpp"
#include "tests/support/panda.hpp"

namespace fovea::control {
namespace {

using model::Pose;
using model::VecN;

class WayToGoalTest : public testing::Test {
 protected:
  WayToGoalTest() : config_(test::PandaConfig()) {
    config_.feature.target = hal::FeatureKind::kTriangle;
    config_.feature.form = features::FeatureForm::kPose;
    config_.feature.corners = features::MakeTriangle(features::kDefaultTriangle);
  }

  [[nodiscard]] Pose CameraAt(const VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    return poses.X_BE * config_.X_EC;
  }

  // Places the target so that the camera is at its goal with the joints at `q`.
  void PutTargetFor(const VecN& q) {
    X_BO_ = CameraAt(q) * Pose{config_.feature.R_CO_star, config_.feature.p_CO_C_star};
  }

  // The arm stands at `q` for `ticks`.
  void Stand(const VecN& q, int ticks, hal::LimitSet limits = 0) {
    for (int i = 0; i < ticks; ++i) {
      now_ns_ += hal::kTickPeriodNs;
      WaySight sight{X_BO_, CameraAt(q).Inverse() * X_BO_, q};
      sight.limits = limits;
      sight.now_ns = now_ns_;
      sight.is_told_apart = told_apart_;
      ChooseWay(config_, sight, way_);
    }
  }

  void Steer(const VecN& q, MotionTask& task) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    model::Mat6N J_C;
    model::ComputeJacobian(config_.arm, poses, config_.X_EC, J_C);
    const features::TargetInCamera seen{CameraAt(q).Inverse() * X_BO_, model::Vec3::Zero(),
                                        model::Vec3::Zero()};
    SteerByJoints(way_, q, seen, J_C, config_.feature.p_CO_C_star, task);
  }

  // The last joint is near its upper end, the goal a third of a turn further: only the long way round leads
  // there. Returns the start.
  VecN PutTargetPastTheEnd() {
    VecN q = test::Ready();
    q[6] = config_.arm.joints[6].q_max - 0.1;
    VecN q_goal = q;
    q_goal[6] = q[6] + 2.0 - 2.0 * model::kPi;
    PutTargetFor(q_goal);
    return q;
  }

  config::ServoConfig config_;
  Pose X_BO_;
  WayToGoal way_;
  std::int64_t now_ns_ = 0;
  bool told_apart_ = true;
};

TEST_F(WayToGoalTest, DownhillGoalIsLeftToTheVisualLaw) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  PutTargetFor(q_goal);
  Stand(test::Ready(), 1000);
  EXPECT_TRUE(way_.goal.found);
  EXPECT_TRUE(way_.goal.downhill);
  EXPECT_FALSE(way_.by_joints);
}

TEST_F(WayToGoalTest, GoalInAnotherPostureIsReachedByJointMotion) {
  const VecN q = PutTargetPastTheEnd();
  Stand(q, 1000);
  ASSERT_TRUE(way_.goal.found);
  EXPECT_FALSE(way_.goal.downhill);
  ASSERT_TRUE(way_.by_joints);

  MotionTask task;
  Steer(q, task);
  EXPECT_GT(task.v.dot(VecN(way_.goal.q - q)), 0.0);
  EXPECT_LT(task.v.lpNorm<Eigen::Infinity>(), 2.0);

  Stand(way_.goal.q, 1);
  EXPECT_FALSE(way_.by_joints) << "at the goal posture the law takes over";
}

TEST_F(WayToGoalTest, JointMotionWaitsForAnUnambiguousTargetPose) {
  told_apart_ = false;
  const VecN q = PutTargetPastTheEnd();
  Stand(q, 1000);
  EXPECT_TRUE(way_.goal.found);
  EXPECT_FALSE(way_.by_joints);
}

TEST_F(WayToGoalTest, LawBlockedByLimitsSwitchesToJointMotion) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  PutTargetFor(q_goal);
  Stand(test::Ready(), 200, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_FALSE(way_.by_joints);
  Stand(test::Ready(), 400, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_TRUE(way_.by_joints);
}

// Joint motion would come no nearer to it than the law.
TEST_F(WayToGoalTest, DownhillPostureWithABlockedPathIsAbandoned) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.8;
  PutTargetFor(q_goal);
  config_.guard.view = {true, 0.4, 0.5, 0.3, 0.4};  // no path keeps the target in this view
  Stand(test::Ready(), 300, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_TRUE(way_.goal.downhill);
  EXPECT_FALSE(way_.goal.clear);
  Stand(test::Ready(), 300, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_FALSE(way_.by_joints);
  EXPECT_FALSE(way_.goal.found) << "the search continues";
}

TEST_F(WayToGoalTest, PostureBlockedByLimitsIsReplacedByAnother) {
  const VecN q = PutTargetPastTheEnd();
  Stand(q, 1000);
  ASSERT_TRUE(way_.by_joints);
  const VecN first = way_.goal.q;
  MotionTask task;
  int ticks = 0;
  for (; ticks < 1000 && way_.goal.found; ++ticks) {
    Steer(q, task);
    EXPECT_TRUE(NoteHeld(task, VecN::Zero(q.size()), way_));
    Stand(q, 1);
  }
  EXPECT_LT(ticks, 1000);
  Steer(q, task);
  EXPECT_EQ(task.v.norm(), 0.0) << "the arm stands during the search";

  X_BO_.p.x() += 1.0;  // out of reach, so that the search goes on
  int first_held = -1;
  for (int i = 0; i < 2000; ++i) {
    first_held = first_held < 0 && NoteHeld(task, VecN::Zero(q.size()), way_) ? i : first_held;
    Stand(q, 1);
  }
  EXPECT_NEAR(first_held, 1500, 5) << "the longest time of a search";
  EXPECT_EQ((way_.goal.q_dropped[0] - first).norm(), 0.0) << "a posture that was only tried is not dropped";
  X_BO_.p.x() -= 1.0;
  Stand(q, 3000);
  ASSERT_TRUE(way_.goal.found);
  EXPECT_GT((way_.goal.q - first).lpNorm<Eigen::Infinity>(), 0.1);
}

// While no posture is downhill or has a clear path, the arm stands and the search goes on: the law would lead
// into a dead end.
TEST_F(WayToGoalTest, ArmStandsUntilAClearPathIsFound) {
  const VecN q = PutTargetPastTheEnd();
  config_.guard.view = {true, 0.4, 0.5, 0.3, 0.4};  // no path keeps the target in this view
  Stand(q, 1000);
  EXPECT_TRUE(way_.by_joints);
  EXPECT_FALSE(way_.goal.found);
  MotionTask task;
  Steer(q, task);
  EXPECT_EQ(task.v.norm(), 0.0);
  config_.guard.view = {};
  Stand(q, 400);
  EXPECT_TRUE(way_.by_joints);
  EXPECT_TRUE(way_.goal.found);
  EXPECT_TRUE(way_.goal.clear);
}

TEST_F(WayToGoalTest, LawTakesOverWhenNoClearPathIsFoundInTime) {
  const VecN q = PutTargetPastTheEnd();
  config_.guard.view = {true, 0.4, 0.5, 0.3, 0.4};
  Stand(q, 1490);
  EXPECT_TRUE(way_.by_joints);
  Stand(q, 20);
  EXPECT_FALSE(way_.by_joints) << "then the law may try";
}

TEST_F(WayToGoalTest, DetourPostureIsVisitedBeforeTheGoal) {
  const VecN q = PutTargetPastTheEnd();
  Stand(q, 1000);
  ASSERT_TRUE(way_.by_joints);
  way_.goal.detour = 1;
  way_.goal.q_via = q;
  way_.goal.q_via[6] += 0.5;
  MotionTask task;
  Steer(q, task);
  EXPECT_GT(task.v[6], 0.5);
  VecN on_the_way = way_.goal.q_via;
  on_the_way[6] -= 0.2;
  Stand(on_the_way, 1);
  EXPECT_EQ(way_.goal.detour, 1);
  on_the_way[6] += 0.1;
  Stand(on_the_way, 1);
  EXPECT_EQ(way_.goal.detour, 0);
  Steer(on_the_way, task);
  EXPECT_LT(task.v[6], -0.5);
}

// A posture downhill from the start may be far away when the law gets stuck.
TEST_F(WayToGoalTest, StuckLawStartsANewPostureSearchFromThere) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  PutTargetFor(q_goal);
  Stand(test::Ready(), 100);
  ASSERT_TRUE(way_.goal.downhill);
  const VecN far = way_.goal.q;
  VecN elsewhere = q_goal;
  elsewhere[0] += 0.8;  // the third joint turns back, so that the elbow swings
  elsewhere[2] -= 0.8;
  Stand(elsewhere, 600, hal::Bit(hal::Limit::kWorkspace));
  ASSERT_TRUE(way_.goal.found);
  EXPECT_LT((way_.goal.q - elsewhere).norm(), 0.9 * (far - elsewhere).norm());
}

// A ball can be seen from any side: while the law makes progress, no search runs.
TEST_F(WayToGoalTest, SphereStartsAPostureSearchOnlyOnceTheLawIsStuck) {
  config_.feature = features::TargetFeature{};
  ASSERT_TRUE(SeeksGoalPosture(config_));
  VecN q_goal = test::Ready();
  q_goal[0] += 0.4;
  X_BO_ = CameraAt(q_goal) * Pose{model::Mat3::Identity(), config_.feature.p_CO_C_star};
  Stand(test::Ready(), 2000);
  EXPECT_FALSE(way_.goal.begun || way_.goal.found);
  Stand(test::Ready(), 1700, hal::Bit(hal::Limit::kWorkspace));
  ASSERT_TRUE(way_.goal.found);
  EXPECT_TRUE(way_.by_joints);
  const model::Vec3 p_CO = CameraAt(way_.goal.q).Inverse() * X_BO_.p;
  EXPECT_LT((p_CO - config_.feature.p_CO_C_star).norm(), 3e-3);
}

}  // namespace
}  // namespace fovea::control
