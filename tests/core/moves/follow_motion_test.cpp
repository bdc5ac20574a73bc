// SPDX-License-Identifier: Apache-2.0
// Commanded motions on an ideal arm: the goal is reached exactly, or the motion is refused.
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "tests/core/moves/moved_arm.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::moves {
namespace {

using hal::HoldReason;

TEST_F(FollowMotionTest, JointGoalIsReachedBitExact) {
  test::RandomStates random(5);
  for (int n = 0; n < 5; ++n) {
    const model::VecN goal = test::Ready() + random.Joints(config_.arm, 0.3);
    EXPECT_EQ(Tick(JointGoal(goal)).mode, Mode::kMove) << "in the tick of the command";
    EXPECT_GT(RunToHold(), 100);
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone);
    EXPECT_EQ((Reference() - goal).norm(), 0.0);
    EXPECT_LT((arm_->q() - goal).norm(), 1e-3);
  }
  std::cout << "largest share of a limit: " << most_ << "\n";
  EXPECT_LE(most_, 1.0);
}

TEST_F(FollowMotionTest, NewGoalTakesEffectInTheSameTick) {
  test::RandomStates random(6);
  Tick(JointGoal(test::Ready() + random.Joints(config_.arm, 0.3)));
  for (int n = 0; n < 30; ++n) {
    const int wait = 20 + 37 * n % 400;
    for (int i = 0; i < wait && record().mode == Mode::kMove; ++i) {
      Tick({});
    }
    const model::VecN goal = test::Ready() + random.Joints(config_.arm, 0.3);
    Tick(JointGoal(goal));
    ASSERT_EQ(record().mode, Mode::kMove) << "goal " << n;
    EXPECT_EQ(task_.state().motion.goal.q, model::ToArray(goal));
    EXPECT_EQ(task_.state().motion.start_ns, record().stamp_ns);
  }
  RunToHold();
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone);
  std::cout << "largest share of a limit: " << most_ << "\n";
  EXPECT_LE(most_, 1.0);
}

TEST_F(FollowMotionTest, PoseGoalIsReachedOnAStraightLine) {
  const model::Pose start = PoseOf(arm_->q());
  const model::Vec3 goal = start.p + model::Vec3(0.05, -0.20, 0.08);
  const model::Mat3 R_goal = model::RotationOf({0.2, 0.1, -0.3}) * start.R;
  Tick(Pose(MotionKind::kPoseGoal, goal, model::RotationVector(R_goal)));
  const model::Vec3 line = (goal - start.p).normalized();
  double worst = 0.0;
  while (record().mode == Mode::kMove) {
    const model::Vec3 way = PoseOf(Reference()).p - start.p;
    worst = std::max(worst, (way - way.dot(line) * line).norm());
    Tick({});
  }
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone);
  const model::Pose end = PoseOf(Reference());
  std::cout << "off the line by " << 1e3 * worst << " mm at most; at the end off by "
            << 1e3 * (end.p - goal).norm() << " mm; largest share of a limit " << most_ << "\n";
  EXPECT_LT(worst, 3e-4);
  EXPECT_LT((end.p - goal).norm(), 1e-5);
  EXPECT_LT(model::RotationVector(end.R * R_goal.transpose()).norm(), 1e-4);
  EXPECT_LE(most_, 1.0);
}

TEST_F(FollowMotionTest, FlangeFollowsACircle) {
  const model::Vec3 phi(3.14159265358979, 0.0, 0.0);  // the hand looks down
  constexpr double kRadius = 0.15;
  constexpr double kOmega = 2.0 * 3.14159265358979 * 0.5;
  // The angle reaches its speed within a second without a jump of acceleration: integral of a smooth step.
  const auto angle = [](double t, double& rate) {
    if (t >= 1.0) {
      rate = kOmega;
      return kOmega * (t - 0.5);
    }
    rate = kOmega * t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
    return kOmega * t * t * t * t * (2.5 + t * (-3.0 + t));
  };
  const model::Vec3 centre(0.45, 0.0, 0.50);
  Tick(Pose(MotionKind::kPoseGoal, centre - model::Vec3(0.0, 0.0, kRadius), phi));
  RunToHold();
  ASSERT_EQ(record().hold_reason, HoldReason::kMotionDone);
  double worst = 0.0;
  double worst_reference = 0.0;
  for (int tick = 0; tick < 6000; ++tick) {
    double rate = 0.0;
    const double a = angle(1e-3 * tick, rate);
    const model::Vec3 p = centre + kRadius * model::Vec3(0.0, std::sin(a), -std::cos(a));
    const model::Vec3 v = kRadius * rate * model::Vec3(0.0, std::cos(a), std::sin(a));
    worst = std::max(worst, (PoseOf(arm_->q()).p - p).norm());
    ASSERT_EQ(Tick(Pose(MotionKind::kPoseSetpoint, p, phi, v)).mode, Mode::kMove) << "tick " << tick;
    worst_reference = std::max(worst_reference, (PoseOf(Reference()).p - p).norm());
  }
  std::cout << "flange off the circle by " << 1e3 * worst << " mm at most, reference by "
            << 1e3 * worst_reference << " mm; largest share of a limit " << most_ << "\n";
  EXPECT_LT(worst, 1e-4);
  EXPECT_LE(most_, 1.0);
  EXPECT_EQ(record().fault, hal::Fault::kNone);
}

TEST_F(FollowMotionTest, InvalidMotionIsRefusedAndTheArmStops) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const model::VecN ready = test::Ready();
  std::vector<MotionCommand> bad(4, Joints(MotionKind::kJointSetpoint, ready));
  bad[0].q[2] += 0.01;  // a jump
  bad[1].dq[2] = 100.0;
  bad[2].ddq[2] = nan;
  bad[3].kind = MotionKind::kJointGoal;
  bad[3].q[3] = nan;
  bad.push_back(Pose(MotionKind::kPoseGoal, {nan, 0.0, 0.5}, model::Vec3::Zero()));
  bad.push_back(Pose(MotionKind::kPoseGoal, {0.4, 0.0, 0.5}, model::Vec3::Zero()));
  bad.back().quaternion_BE = {0.0, 0.0, 0.0, 0.0};
  bad.push_back(Pose(MotionKind::kPoseSetpoint, {0.4, 0.3, 0.9}, model::Vec3::Zero()));
  for (std::size_t i = 0; i < bad.size(); ++i) {
    Start(test::PandaConfig(), ready);
    const model::VecN before = Reference();
    Tick(bad[i]);
    Tick({});
    EXPECT_EQ(record().mode, Mode::kHold) << "case " << i;
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused) << "case " << i;
    EXPECT_EQ((Reference() - before).norm(), 0.0) << "case " << i;
    EXPECT_EQ(record().fault, hal::Fault::kNone);
    EXPECT_EQ(Tick(JointGoal(ready)).mode, Mode::kMove) << "a valid motion is accepted, case " << i;
  }
}

// An unknown load makes the arm sag. A mean error that is too large ends the motion, a short push does not.
TEST_F(FollowMotionTest, PersistentMotionErrorEndsInHold) {
  config::ServoConfig config = test::PandaConfig();
  config.safety.motion_error = 1e-3;
  const model::VecN ready = test::Ready();
  const auto run = [&](double ddq, int ticks) {
    Start(config, ready);
    int moved = 0;
    for (int i = 0; i < 2000; ++i) {
      if (i < ticks) {
        arm_->SetVelocity(arm_->dq() + 1e-3 * ddq * model::VecN::Unit(7, 1));
      }
      moved += Tick(Joints(MotionKind::kJointSetpoint, ready)).mode == Mode::kMove ? 1 : 0;
    }
    const double off = (ready - arm_->q()).lpNorm<Eigen::Infinity>();
    std::cout << "pulled by " << ddq << " rad/s^2 for " << ticks << " ms: off by " << off << " rad, "
              << hal::Name(record().mode) << ", " << hal::Name(record().hold_reason) << " after " << moved
              << " ms\n";
    return off;
  };
  EXPECT_GT(run(1.0, 2000), 1e-3);
  EXPECT_EQ(record().mode, Mode::kHold) << "a command that goes on does not restart the motion";
  EXPECT_EQ(record().hold_reason, HoldReason::kNotFollowed);
  EXPECT_EQ(record().fault, hal::Fault::kNone);
  Tick({});
  EXPECT_EQ(Tick(Joints(MotionKind::kJointSetpoint, ready)).mode, Mode::kMove)
      << "a new command restarts the motion";
  run(2.0, 50);
  EXPECT_EQ(record().mode, Mode::kMove);
  EXPECT_LT(run(0.5, 2000), 1e-3);
  EXPECT_EQ(record().mode, Mode::kMove);
}

// A goal may be commanded in every tick. Once reached, it starts again only after another command or none.
TEST_F(FollowMotionTest, ReachedGoalRequestedAgainIsNotRestarted) {
  const model::VecN ready = test::Ready();
  model::VecN there = ready;
  there[0] += 0.2;
  MotionCommand home;
  home.kind = MotionKind::kHome;
  const auto ask = [&](const MotionCommand& command) {
    int moved = 0;
    for (int i = 0; i < 3000; ++i) {
      moved += Tick(command).mode == Mode::kMove ? 1 : 0;
    }
    EXPECT_EQ(record().mode, Mode::kHold);
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone);
    return moved;
  };
  EXPECT_GT(ask(JointGoal(there)), 100);
  EXPECT_EQ(ask(JointGoal(there)), 0);
  EXPECT_GT(ask(home), 100);
  EXPECT_LT((Reference() - ready).norm(), 1e-9);
  EXPECT_EQ(ask(home), 0);
  EXPECT_GT(ask(Pose(MotionKind::kPoseGoal, PoseOf(there).p, model::RotationVector(PoseOf(there).R))), 100);
  Tick({});
  EXPECT_GT(ask(Pose(MotionKind::kPoseGoal, PoseOf(there).p, model::RotationVector(PoseOf(there).R))), 0)
      << "a new command starts it again";
}

TEST_F(FollowMotionTest, HoldRequestEndsAMotionForGood) {
  model::VecN goal = test::Ready();
  goal[0] += 1.0;
  Tick(JointGoal(goal));
  for (int i = 0; i < 300; ++i) {
    Tick({});
  }
  EXPECT_EQ(Tick({}, task::Request::kHold).mode, Mode::kHold);
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(Tick({}).mode, Mode::kHold);
  }
  EXPECT_LE(most_, 1.0);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
  EXPECT_GT((arm_->q() - goal).norm(), 0.1);
}

}  // namespace
}  // namespace fovea::moves
