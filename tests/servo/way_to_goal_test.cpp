#include "fovea/servo/way_to_goal.hpp"

#include <gtest/gtest.h>

#include "fovea/features/triangle.hpp"
#include "support/panda.hpp"

namespace fovea::servo {
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

  // A target that the camera has at its goal with the joints at `q`.
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

  // The last joint near its upper end, the goal a third of a turn further: only the long way round leads
  // there.
  VecN PutTargetPastTheEnd() {
    VecN q = test::Ready();
    q[6] = config_.arm.joints[6].q_max - 0.1;
    VecN q_goal = q;
    q_goal[6] = q[6] + 2.0 - 2.0 * model::kPi;
    PutTargetFor(q_goal);
    return q;
  }

  ServoConfig config_;
  Pose X_BO_;
  WayToGoal way_;
  std::int64_t now_ns_ = 0;
  bool told_apart_ = true;
};

TEST_F(WayToGoalTest, DownhillTheLawGoes) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  PutTargetFor(q_goal);
  Stand(test::Ready(), 1000);
  EXPECT_TRUE(way_.goal.found);
  EXPECT_TRUE(way_.goal.downhill);
  EXPECT_FALSE(way_.by_joints);
}

TEST_F(WayToGoalTest, APostureElsewhereIsGoneToByTheJoints) {
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
  EXPECT_FALSE(way_.by_joints) << "there, the law takes over";
}

TEST_F(WayToGoalTest, NotBeforeTheTargetsPosesAreToldApart) {
  told_apart_ = false;
  const VecN q = PutTargetPastTheEnd();
  Stand(q, 1000);
  EXPECT_TRUE(way_.goal.found);
  EXPECT_FALSE(way_.by_joints);
}

TEST_F(WayToGoalTest, LimitsThatLetTheGoalComeNoNearerMakeItGoByTheJoints) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.3;
  PutTargetFor(q_goal);
  Stand(test::Ready(), 200, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_FALSE(way_.by_joints);
  Stand(test::Ready(), 400, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_TRUE(way_.by_joints);
}

// The joints would get no further to it than the law.
TEST_F(WayToGoalTest, ADownhillPostureWithABarredWayIsNotGoneToByTheJoints) {
  VecN q_goal = test::Ready();
  q_goal[0] += 0.8;
  PutTargetFor(q_goal);
  config_.guard.view = {true, 0.4, 0.5, 0.3, 0.4};  // no way keeps it in there
  Stand(test::Ready(), 300, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_TRUE(way_.goal.downhill);
  EXPECT_FALSE(way_.goal.clear);
  Stand(test::Ready(), 300, hal::Bit(hal::Limit::kWorkspace));
  EXPECT_FALSE(way_.by_joints);
  EXPECT_FALSE(way_.goal.found) << "another one is looked for";
}

TEST_F(WayToGoalTest, APostureThatLimitsHoldUpIsGivenUpForAnother) {
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
  EXPECT_EQ(task.v.norm(), 0.0) << "stands while it looks for another";

  X_BO_.p.x() += 1.0;  // out of reach, so that it looks on
  for (int i = 0; i < 1000; ++i) {
    EXPECT_TRUE(NoteHeld(task, VecN::Zero(q.size()), way_));
    Stand(q, 1);
  }
  EXPECT_EQ((way_.goal.q_dropped[0] - first).norm(), 0.0) << "what it only tries is not given up";
  X_BO_.p.x() -= 1.0;
  Stand(q, 3000);
  ASSERT_TRUE(way_.goal.found);
  EXPECT_GT((way_.goal.q - first).lpNorm<Eigen::Infinity>(), 0.1);
}

}  // namespace
}  // namespace fovea::servo
