// SPDX-License-Identifier: Apache-2.0
// Which way the servo takes: every change of the drawing in way_to_goal.hpp, and when it does not happen.
#include "firmware/core/control/way_to_goal.hpp"

#include <cmath>

#include "firmware/core/features/equal_turn.hpp"
#include "tests/core/control/planned_way.hpp"

namespace fovea::control {
namespace {

using hal::PlanEvent;
using hal::Way;
using WayToGoalTest = PlannedWay;

constexpr int kSecond = 1000;  // ticks

TEST_F(WayToGoalTest, FarGoalIsPlannedForAndReached) {
  normal_B_ = {0.1, -0.2, 0.3};
  reference_.dq[2] = 0.1;
  EXPECT_EQ(Choose(), PlanEvent::kNone);
  EXPECT_EQ(way_.note.way, Way::kAwaitPlan);
  Choose(50);
  EXPECT_EQ(way_.note.plans_asked, 0) << "the arm still moves";
  StandAt(reference_.q);
  EXPECT_EQ(Choose(), PlanEvent::kAsked);
  EXPECT_EQ(way_.asked_ns, now_ns_);
  EXPECT_EQ(way_.note.plans_asked, 1);
  EXPECT_EQ(way_.note.tries, 1);
  EXPECT_EQ(way_.note.normal_B[1], -0.2);
  Choose(20);
  EXPECT_EQ(way_.note.plans_asked, 1) << "it waits for the answer";
  EXPECT_EQ(Answer(PlanToGoal()), PlanEvent::kTaken);
  EXPECT_EQ(way_.note.way, Way::kPlan);
  EXPECT_EQ(FollowOn(), PlanEvent::kDone);
  EXPECT_LT((reference_.q - q_goal_).lpNorm<Eigen::Infinity>(), 1e-4);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  Choose(10 * kSecond);
  EXPECT_EQ(events_, (std::vector{PlanEvent::kAsked, PlanEvent::kTaken, PlanEvent::kDone}))
      << "each is told once, and nothing is asked for at the goal";
}

TEST_F(WayToGoalTest, NearGoalIsLeftToTheLaw) {
  q_goal_ = test::Ready();
  q_goal_[0] += 0.08;
  PutTargetFor(q_goal_);
  Choose(10 * kSecond);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.note.plans_asked, 0);
}

TEST_F(WayToGoalTest, MovingTargetIsLeftToTheLaw) {
  v_BO_ = {0.0, 0.2, 0.0};
  Choose(5 * kSecond);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.note.plans_asked, 0);
  v_BO_.setZero();
  AskForPlan();
}

// The law's motion tells the poses apart, unless limits stop it.
TEST_F(WayToGoalTest, TargetOfTwoPossiblePosesIsLeftToTheLaw) {
  told_apart_ = false;
  Choose(5 * kSecond);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.note.plans_asked, 0);
  told_apart_ = true;
  AskForPlan();
  way_.Restart();
  told_apart_ = false;
  limits_ = hal::Bit(hal::Limit::kWorkspace);
  AskForPlan();
}

// A slow arm stops at once; a fast one fades the law out before it asks.
TEST_F(WayToGoalTest, FastArmSlowsDownWithItsLaw) {
  EXPECT_EQ(SlowingPace(way_, reference_), 0.0) << "no plan is awaited";
  reference_.dq[3] = 0.5;
  Choose();
  ASSERT_EQ(way_.note.way, Way::kAwaitPlan);
  double last = 1.0;
  EXPECT_EQ(SlowingPace(way_, reference_), last);
  for (int i = 0; i < kSecond / 2; ++i) {
    Choose();
    EXPECT_EQ(way_.note.event, hal::PlanEvent::kNone) << "asks at rest only";
    const double pace = SlowingPace(way_, reference_);
    EXPECT_LE(pace, last);
    EXPECT_GT(pace, last - 0.01) << "no jump";
    last = pace;
  }
  EXPECT_EQ(last, 0.0);
  way_.pace = 0.5;
  reference_.dq[3] = 0.05;
  EXPECT_EQ(SlowingPace(way_, reference_), 0.0);
  reference_.dq.setZero();
  AskForPlan();
  reference_.dq[3] = 0.5;
  EXPECT_EQ(SlowingPace(way_, reference_), 0.0) << "asked: the arm stands";
}

// The law may have to stop for a plan as soon as the poses are told apart.
TEST_F(WayToGoalTest, LawIsSlowWhileItTellsPosesApart) {
  told_apart_ = false;
  Choose(kSecond);
  EXPECT_LT(way_.pace, 0.5);
  Choose(kSecond);
  EXPECT_EQ(way_.pace, 1.0) << "not for long";
  way_.Restart();
  q_goal_ = test::Ready();
  q_goal_[0] += 0.08;
  PutTargetFor(q_goal_);
  Choose();
  EXPECT_EQ(way_.pace, 1.0) << "near the goal no plan follows";
}

// A limit that may block the path, not one that only slows the motion down.
TEST_F(WayToGoalTest, LawThatLimitsStopAsksForAPlan) {
  q_goal_ = test::Ready();
  q_goal_[0] += 0.08;
  PutTargetFor(q_goal_);
  for (int i = 0; i < hal::kNumLimits; ++i) {
    way_.Restart();
    limits_ = hal::LimitSet{1} << static_cast<unsigned>(i);
    Choose(kSecond);
    EXPECT_EQ(way_.note.way == Way::kAwaitPlan, (limits_ & kBarriers) != 0) << i;
  }
  way_.Restart();
  for (int i = 0; i < 5 * kSecond; ++i) {
    limits_ = i % 2 == 0 ? kBarriers : 0;
    Choose();
  }
  EXPECT_EQ(way_.note.way, Way::kLaw) << "half of the time is no stop";
}

// As long as the distance shrinks, limits on the way do not matter.
TEST_F(WayToGoalTest, LawThatMakesProgressAsksForNoPlan) {
  limits_ = kBarriers;
  double off = 0.08;
  for (int i = 0; i < 16; ++i, off *= 0.75) {
    model::VecN q = q_goal_;
    q[0] -= off;
    StandAt(q);
    Choose(300);
    EXPECT_EQ(way_.note.plans_asked, 0) << off;
  }
  EXPECT_NEAR(off, 8e-4, 1e-4);
  StandAt(q_goal_);
  Choose(5 * kSecond);
  EXPECT_EQ(way_.note.way, Way::kLaw) << "at the goal limits do not matter";
}

TEST_F(WayToGoalTest, WithoutAMotionTheLawGoesOnAlone) {
  AskForPlan();
  trajectory::Plan none;
  none.outcome = trajectory::PlanOutcome::kNoGoalPosture;
  EXPECT_EQ(Answer(none), PlanEvent::kNoMotion);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.note.outcome, static_cast<int>(trajectory::PlanOutcome::kNoGoalPosture));
  EXPECT_FALSE(KeepsPosture(way_, X_BO_.p));
  Choose(10 * kSecond);
  EXPECT_EQ(way_.note.plans_asked, 1) << "the same question has the same answer";
  limits_ = hal::Bit(hal::Limit::kJointPosition);
  AskForPlan();
  EXPECT_EQ(way_.note.tries, 4) << "a sure answer counts three times";
}

// A target that turns in place is followed by the law, which compensates the turn.
TEST_F(WayToGoalTest, TurningTargetIsFollowedByTheLaw) {
  w_BO_ = {0.0, 0.0, 0.6};
  Choose(5 * kSecond);
  EXPECT_EQ(way_.note.plans_asked, 0);
  w_BO_.setZero();
  AskForPlan();
}

// Plans that limits hold up one after the other end, too: the law goes on, and can find the goal unreachable.
TEST_F(WayToGoalTest, PlansThatAreHeldUpEnd) {
  AskForPlan();
  for (int k = 1; way_.note.way != Way::kLaw && k < 20; ++k) {
    ASSERT_EQ(Answer(PlanToGoal()), PlanEvent::kTaken);
    FollowFor(300);
    PlanEvent event = PlanEvent::kNone;
    for (int i = 0; i < 3000 && event == PlanEvent::kNone; ++i) {
      Follow(/*held=*/true);
      event = Choose();
    }
    ASSERT_EQ(event, PlanEvent::kHeld) << k;
    if (way_.note.way == Way::kAwaitPlan) {
      reference_.dq.setZero();
      reference_.ddq.setZero();
      AskForPlan();
    }
  }
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.note.tries, 6);
}

TEST_F(WayToGoalTest, TriesForOneGoalAreLimited) {
  limits_ = kBarriers;
  trajectory::Plan none;
  none.outcome = trajectory::PlanOutcome::kNoPath;
  int answers = 0;
  for (; answers < 100 && TicksUntil(PlanEvent::kAsked) > 0; ++answers) {
    Answer(none);
  }
  EXPECT_GE(answers, 2);
  EXPECT_LE(answers, 10);
  EXPECT_EQ(way_.note.tries, answers);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_TRUE(HasNoWay(config_.law, way_)) << "limits stopped the law for seconds";
  limits_ = 0;
  Choose(10 * kSecond);
  EXPECT_FALSE(HasNoWay(config_.law, way_)) << "nothing stops the law";
  limits_ = kBarriers;
  // Also near the goal, where limits still stop the law.
  const model::VecN start = reference_.q;
  model::VecN near = q_goal_;
  near[0] += 0.01;
  StandAt(near);
  EXPECT_EQ(TicksUntil(PlanEvent::kAsked), -1);
  EXPECT_TRUE(HasNoWay(config_.law, way_));
  StandAt(start);
  EXPECT_EQ(TicksUntil(PlanEvent::kAsked), -1);
  // A goal that was reached is a new one afterwards.
  const model::VecN far = reference_.q;
  StandAt(q_goal_);
  Choose();
  EXPECT_EQ(way_.note.tries, 0);
  EXPECT_FALSE(HasNoWay(config_.law, way_)) << "it is there";
  StandAt(far);
  AskForPlan();
  EXPECT_EQ(way_.note.tries, 1);
  EXPECT_EQ(way_.note.plans_asked, answers + 1);
}

TEST_F(WayToGoalTest, PlanForAnotherStartOrTargetIsRefused) {
  const auto refused = [this](const auto& change) {
    way_ = WayToGoal{};
    EXPECT_GT(TicksUntil(PlanEvent::kAsked), 0);
    trajectory::Plan plan = PlanToGoal();
    change(plan);
    return Answer(plan) == PlanEvent::kStale && way_.note.way == Way::kLaw && way_.q_end.size() == 0;
  };
  EXPECT_FALSE(refused([](trajectory::Plan&) {}));
  for (int joint = 0; joint < 7; ++joint) {
    EXPECT_TRUE(refused([this, joint](trajectory::Plan& plan) {
      model::VecN q = reference_.q;
      q[joint] += 1e-6;
      plan = PlanTo(q, q_goal_);
    })) << joint;
  }
  EXPECT_TRUE(refused([this](trajectory::Plan& plan) {
    plan = PlanTo(reference_.q.head(6), q_goal_.head(6));
  })) << "of another arm";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(refused([axis](trajectory::Plan& plan) { plan.p_BO[axis] += 0.15; })) << axis;
    EXPECT_TRUE(refused([axis](trajectory::Plan& plan) { plan.p_BO[axis] -= 0.15; })) << axis;
  }
  EXPECT_TRUE(refused([this](trajectory::Plan& plan) {
    plan.q_BO = model::QuaternionOf(X_BO_.R * model::RotationOf(model::Vec3(0.0, 0.4, 0.0)));
  }));
  EXPECT_TRUE(refused([](trajectory::Plan& plan) { plan.p_BO[0] = std::nan(""); }));
}

TEST_F(WayToGoalTest, AfterAStalePlanAnotherOneIsAskedFor) {
  int stale = 0;
  while (TicksUntil(PlanEvent::kAsked, 2000) > 0) {
    trajectory::Plan plan = PlanToGoal();
    plan.p_BO[2] += 0.5;
    ASSERT_EQ(Answer(plan), PlanEvent::kStale);
    ASSERT_LT(++stale, 20);
  }
  EXPECT_GE(stale, 2);
}

TEST_F(WayToGoalTest, LatePlannerIsNotWaitedForAgain) {
  AskForPlan();
  const std::int64_t asked_ns = way_.asked_ns;
  EXPECT_NEAR(TicksUntil(PlanEvent::kLate), 2000, 2);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.late_ns, asked_ns);
  way_.Restart();
  EXPECT_EQ(way_.note.plans_asked, 1) << "the number of a request is never used twice";
  AskForPlan();
  EXPECT_EQ(way_.note.plans_asked, 2);
  EXPECT_NEAR(TicksUntil(PlanEvent::kLate), 100, 2);
  way_.Restart();
  AskForPlan();
  ASSERT_EQ(Answer(PlanToGoal()), PlanEvent::kTaken);
  way_.Restart();
  AskForPlan();
  EXPECT_NEAR(TicksUntil(PlanEvent::kLate), 2000, 2) << "it answers again";
}

// Nobody has searched: when the planner answers, it gets all its tries.
TEST_F(WayToGoalTest, RequestsWithoutAnAnswerAreNoTries) {
  limits_ = kBarriers;
  EXPECT_TRUE(MayFindAWay(config_, way_));
  for (int i = 0; i < 10; ++i) {
    AskForPlan();
    EXPECT_EQ(way_.note.tries, 1);
    EXPECT_GT(TicksUntil(PlanEvent::kLate), 0);
    EXPECT_EQ(way_.note.tries, 0);
    EXPECT_FALSE(MayFindAWay(config_, way_)) << "the law is alone";
    Choose(300);
    EXPECT_FALSE(HasNoWay(config_.law, way_)) << "no plan was tried";
  }
  Choose(900);
  EXPECT_TRUE(HasNoWay(config_.law, way_)) << "limits stop the law, and nobody plans";
  way_.late_ns = -1;
  EXPECT_TRUE(MayFindAWay(config_, way_));
}

TEST_F(WayToGoalTest, AWayMayBeFoundWhileThePlannerMayBeAskedOrItsPlanIsFollowed) {
  EXPECT_TRUE(MayFindAWay(config_, way_));
  config_.law.plans = false;
  EXPECT_FALSE(MayFindAWay(config_, way_));
  config_.law.plans = true;
  AskForPlan();
  way_.note.tries = 6;
  EXPECT_TRUE(MayFindAWay(config_, way_)) << "the last one may be good";
  ASSERT_EQ(Answer(PlanToGoal()), PlanEvent::kTaken);
  EXPECT_TRUE(MayFindAWay(config_, way_));
  EXPECT_EQ(FollowOn(), PlanEvent::kDone);
  Choose();
  EXPECT_FALSE(MayFindAWay(config_, way_)) << "no plan leads nearer";
}

TEST_F(WayToGoalTest, LawKeepsThePostureAndTheTurnOfTheLastPlan) {
  config_.feature.target = hal::FeatureKind::kSquare;
  config_.feature.corners = features::MakeSquare(0.08);
  EXPECT_FALSE(KeepsPosture(way_, X_BO_.p));
  AskForPlan();
  // The goal is reached with a quarter of a turn of the square, which looks the same.
  q_goal_[6] += 0.5 * model::kPi;
  trajectory::Plan plan = PlanToGoal();
  plan.turn = features::NearestTurn(config_.feature, CameraAt(q_goal_).R.transpose() * X_BO_.R);
  ASSERT_NE(plan.turn, 0);
  ASSERT_EQ(Answer(plan), PlanEvent::kTaken);
  EXPECT_EQ(FollowOn(), PlanEvent::kDone);
  EXPECT_EQ(way_.since_ns, now_ns_) << "the law starts smoothly";
  EXPECT_LT(reference_.dq.lpNorm<Eigen::Infinity>(), 1e-3) << "from rest";
  EXPECT_EQ((way_.q_end - q_goal_).norm(), 0.0);
  Choose(kSecond);
  EXPECT_EQ(way_.note.way, Way::kLaw);
  EXPECT_EQ(way_.turn, plan.turn);
  EXPECT_TRUE(KeepsPosture(way_, X_BO_.p));
  EXPECT_TRUE(KeepsPosture(way_, X_BO_.p + model::Vec3(0.05, 0.0, 0.0)));
  EXPECT_FALSE(KeepsPosture(way_, X_BO_.p + model::Vec3(0.0, 0.5, 0.0)));
  EXPECT_FALSE(KeepsPosture(way_, model::Vec3(std::nan(""), 0.0, 0.0)));
}

TEST_F(WayToGoalTest, TurnFollowsTheEstimateWhilePosesAreNotToldApart) {
  config_.feature.target = hal::FeatureKind::kSquare;
  config_.feature.corners = features::MakeSquare(0.08);
  told_apart_ = false;
  const model::Mat3 R_BO = X_BO_.R;
  for (int turn = 0; turn < 4; ++turn) {
    X_BO_.R = R_BO * features::EqualTurn(turn, 4).transpose();
    Choose();
    EXPECT_EQ(way_.turn, features::NearestTurn(config_.feature, Sight().X_CO.R)) << turn;
  }
  told_apart_ = true;
  limits_ = 0;
  way_.is_fresh = false;
  const int turn = way_.turn;
  X_BO_.R = R_BO;
  Choose(5);
  EXPECT_EQ(way_.turn, turn) << "then it is kept";
}

}  // namespace
}  // namespace fovea::control
