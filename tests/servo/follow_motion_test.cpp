// Commanded motions on an arm that obeys the model: there exactly, within all limits, or refused.
#include "fovea/servo/follow_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <vector>

#include "fovea/model/rotation.hpp"
#include "fovea/servo/servo_task.hpp"
#include "support/ideal_arm.hpp"
#include "support/panda.hpp"
#include "support/random_states.hpp"

namespace fovea::servo {
namespace {

using hal::HoldReason;
using hal::Mode;

class FollowMotionTest : public testing::Test {
 protected:
  void SetUp() override { Start(test::PandaConfig(), test::Ready()); }

  void Start(ServoConfig config, const model::VecN& q) {
    config.auto_track = false;
    config_ = config;
    most_ = outermost_ = 0.0;
    ASSERT_TRUE(task_.Init(config).ok());
    arm_ = std::make_unique<test::IdealArm>(config.arm, q);
    outputs_ = {};
    for (int i = 0; i < 30; ++i) {
      Tick({});
    }
    ASSERT_EQ(record().mode, Mode::kHold);
  }

  const hal::TickRecord& Tick(const MotionCommand& command, Request request = Request::kNone) {
    ServoInputs inputs;
    inputs.arm = arm_->State();
    inputs.motion = command;
    inputs.request = request;
    const hal::TickRecord before = outputs_.record;
    task_.Step(inputs, outputs_);
    if (before.mode != Mode::kBoot) {
      NoteLimits(before, outputs_.record);
    }
    arm_->Apply(outputs_.command());
    arm_->Step();
    outermost_ = std::max(outermost_, PoseOf(arm_->q()).p.norm());
    return outputs_.record;
  }
  // The largest share of any limit that the reference used.
  void NoteLimits(const hal::TickRecord& before, const hal::TickRecord& now) {
    for (int i = 0; i < config_.arm.num_joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const model::Joint& joint = config_.arm.joints[k];
      most_ =
          std::max({most_, std::fabs(now.dq_cmd[k]) / joint.dq_max, std::fabs(now.ddq_cmd[k]) / joint.ddq_max,
                    std::fabs(now.ddq_cmd[k] - before.ddq_cmd[k]) / (joint.dddq_max * 1e-3)});
    }
  }
  model::Pose PoseOf(const model::VecN& q) const {
    model::ArmPoses poses;
    model::ComputePoses(config_.arm, q, poses);
    return poses.X_BE;
  }
  model::VecN Reference() const { return model::ToVector(record().q_cmd, config_.arm.num_joints); }
  const hal::TickRecord& record() const { return outputs_.record; }

  static MotionCommand Joints(MotionKind kind, const model::VecN& q) {
    MotionCommand command;
    command.kind = kind;
    command.q = model::ToArray(q);
    return command;
  }
  static MotionCommand JointGoal(const model::VecN& q) { return Joints(MotionKind::kJointGoal, q); }
  static MotionCommand Pose(MotionKind kind, const model::Vec3& p, const model::Vec3& phi,
                            const model::Vec3& v = model::Vec3::Zero()) {
    MotionCommand command;
    command.kind = kind;
    const double angle = phi.norm();
    const double scale = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.0;
    command.quaternion_BE = {std::cos(0.5 * angle), scale * phi[0], scale * phi[1], scale * phi[2]};
    for (std::size_t i = 0; i < 3; ++i) {
      command.p_BE[i] = p[static_cast<Eigen::Index>(i)];
      command.V_BE_B[i] = v[static_cast<Eigen::Index>(i)];
    }
    return command;
  }
  // Until the arm stands again; the number of ticks.
  int RunToHold() {
    int ticks = 0;
    while (record().mode == Mode::kMove && ticks < 20000) {
      Tick({});
      ++ticks;
    }
    return ticks;
  }

  ServoConfig config_;
  ServoTask task_;
  ServoOutputs outputs_;
  std::unique_ptr<test::IdealArm> arm_;
  double most_ = 0.0;
  double outermost_ = 0.0;
};

TEST_F(FollowMotionTest, AJointGoalIsReachedToTheBit) {
  test::RandomStates random(5);
  for (int n = 0; n < 5; ++n) {
    const model::VecN goal = test::Ready() + random.Joints(config_.arm, 0.3);
    EXPECT_EQ(Tick(JointGoal(goal)).mode, Mode::kMove) << "in the tick that asks for it";
    EXPECT_GT(RunToHold(), 100);
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionDone);
    EXPECT_EQ((Reference() - goal).norm(), 0.0);
    EXPECT_LT((arm_->q() - goal).norm(), 1e-3);
  }
  std::cout << "largest share of a limit: " << most_ << "\n";
  EXPECT_LE(most_, 1.0);
}

TEST_F(FollowMotionTest, AnotherGoalTakesEffectInTheSameTick) {
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

TEST_F(FollowMotionTest, APoseIsReachedOnAStraightLine) {
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

TEST_F(FollowMotionTest, TheFlangeFollowsACircle) {
  const model::Vec3 phi(3.14159265358979, 0.0, 0.0);  // the hand looks down
  constexpr double kRadius = 0.15;
  constexpr double kOmega = 2.0 * 3.14159265358979 * 0.5;
  // The angle comes up to speed within a second, without a jump of its acceleration: integral of a smooth
  // step.
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

TEST_F(FollowMotionTest, WhatIsNoMotionIsRefusedAndTheArmStops) {
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
    EXPECT_EQ(Tick(JointGoal(ready)).mode, Mode::kMove) << "a good one is taken, case " << i;
  }
}

// Something hangs on the arm that nobody told the servo of, and it sags. The motion ends when the arm is too
// far off on the whole; a push that passes does not end it.
TEST_F(FollowMotionTest, AnArmThatStaysOffItsMotionHolds) {
  ServoConfig config = test::PandaConfig();
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
  EXPECT_EQ(record().mode, Mode::kHold) << "what is asked for on and on is not taken up again";
  EXPECT_EQ(record().hold_reason, HoldReason::kNotFollowed);
  EXPECT_EQ(record().fault, hal::Fault::kNone);
  Tick({});
  EXPECT_EQ(Tick(Joints(MotionKind::kJointSetpoint, ready)).mode, Mode::kMove) << "asked for anew it is";
  run(2.0, 50);
  EXPECT_EQ(record().mode, Mode::kMove);
  EXPECT_LT(run(0.5, 2000), 1e-3);
  EXPECT_EQ(record().mode, Mode::kMove);
}

// A goal may be asked for in every tick: reached, it is done, and not begun anew until something else was
// asked for.
TEST_F(FollowMotionTest, AGoalThatWasReachedIsDoneThoughItIsAskedForOn) {
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
      << "asked for anew";
}

// A goal in reach whose way leads out of the workspace is begun, stopped inside and refused.
TEST_F(FollowMotionTest, AWayOutOfTheWorkspaceIsStopped) {
  ServoConfig config = test::PandaConfig();
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
  std::cout << "came to " << outermost_ << " m of 0.75 m, " << hal::Name(record().hold_reason) << "\n";
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused);
  EXPECT_LT(outermost_, 0.751);
  EXPECT_GT((arm_->q() - q).norm(), 0.05) << "it was begun";
  EXPECT_LE(most_, 1.0);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
}

// A hand that is sent through a plane, and into a box, stops before them.
TEST_F(FollowMotionTest, ObstaclesAreNotEntered) {
  ServoConfig config = test::PandaConfig();
  config.move.pose_error_max = 0.2;  // it shall try for long
  const model::Vec3 p = PoseOf(test::Ready()).p;
  Obstacles plane;
  plane.num_planes = 1;
  plane.planes[0] = {model::Vec3::UnitZ(), p.z() - 0.10};
  Obstacles box;
  box.num_boxes = 1;
  box.boxes[0] = {p + model::Vec3(-0.3, -0.3, -0.4), p + model::Vec3(0.3, 0.3, -0.10)};
  for (const Obstacles& obstacles : {plane, box}) {
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
    EXPECT_LT(lowest, p.z() - 0.09) << "it went there";
    EXPECT_NE(limits & hal::Bit(hal::Limit::kObstacle), 0U);
    EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused);
    EXPECT_EQ(record().fault, hal::Fault::kNone);
    EXPECT_LE(most_, 1.0);
  }
}

TEST_F(FollowMotionTest, TheHandKeepsItsSpeed) {
  ServoConfig config = test::PandaConfig();
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
  EXPECT_EQ(record().hold_reason, HoldReason::kMotionRefused) << "it cannot keep up, and says so";
}

// Stretched out towards the boundary, with a workspace that would allow it: the elbow does not come straight.
TEST_F(FollowMotionTest, ASingularPostureIsNotEntered) {
  ServoConfig config = test::PandaConfig();
  config.guard.workspace_radius = 2.0;
  config.guard.singularity_min = 0.06;
  config.move.pose_error_max = 1.0;  // it shall try for long
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
    Singularity singularity;
    ComputeSingularity(J, SingularityConfig{}.length, singularity);
    least = std::min(least, singularity.sigma);
  }
  std::cout << "smallest singular value " << least << ", allowed 0.06\n";
  EXPECT_GT(least, 0.06 - 0.003);
  EXPECT_LT(least, 0.09) << "it came near";
  EXPECT_NE(limits & hal::Bit(hal::Limit::kSingularity), 0U);
  EXPECT_LE(most_, 1.0);
  EXPECT_EQ(record().fault, hal::Fault::kNone);
}

// Between two motions something else may have moved the arm.
TEST_F(FollowMotionTest, AfterAPauseTheSingularityIsLookedAtAnew) {
  const model::Pose start = PoseOf(arm_->q());
  Tick(Pose(MotionKind::kPoseGoal, start.p + model::Vec3(0.0, 0.05, 0.0), model::RotationVector(start.R)));
  EXPECT_GT(task_.state().motion.resolved.watch.sigma, 0.0);
  RunToHold();
  EXPECT_EQ(task_.state().motion.resolved.watch.sigma, 0.0);
  EXPECT_EQ(task_.state().motion.resolved.dq.size(), 0);
}

TEST_F(FollowMotionTest, AHoldRequestStopsAMotionForGood) {
  model::VecN goal = test::Ready();
  goal[0] += 1.0;
  Tick(JointGoal(goal));
  for (int i = 0; i < 300; ++i) {
    Tick({});
  }
  EXPECT_EQ(Tick({}, Request::kHold).mode, Mode::kHold);
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(Tick({}).mode, Mode::kHold);
  }
  EXPECT_LE(most_, 1.0);
  EXPECT_LT(arm_->dq().norm(), 1e-3);
  EXPECT_GT((arm_->q() - goal).norm(), 0.1);
}

}  // namespace
}  // namespace fovea::servo
