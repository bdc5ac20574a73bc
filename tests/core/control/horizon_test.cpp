// SPDX-License-Identifier: Apache-2.0
// When a predictive law asks for horizons, which it follows, and when it goes on without one.
#include "firmware/core/control/horizon.hpp"

#include "tests/core/control/planned_way.hpp"

namespace fovea::control {
namespace {

using hal::PlanEvent;

class HorizonTest : public PlannedWay {
 protected:
  HorizonTest() {
    config_.law.law = config::Law::kPredictive;
    config_.law.plans = false;
  }

  // One tick. True if the arm follows a horizon.
  bool Tick() {
    now_ns_ += hal::kTickPeriodNs;
    WaySight sight = Sight();
    sight.is_seen = is_seen_;
    sight.has_answer = plans_.IsWhole() && plans_.plan().stamp_ns == way_.asked_ns;
    way_.note.event = PlanEvent::kNone;
    const bool follows = FollowHorizon(config_, sight, plans_, way_, step_);
    if (way_.note.event != PlanEvent::kNone) {
      events_.push_back(way_.note.event);
    }
    return follows;
  }
  // The number of `ticks` in which the arm follows a horizon.
  int Ticks(int ticks) {
    int follows = 0;
    for (int i = 0; i < ticks; ++i) {
      follows += Tick() ? 1 : 0;
    }
    return follows;
  }
  void Answer(const trajectory::Plan& plan, int parts = 1000) {
    trajectory::PlanSender sender;
    sender.Begin(plan);
    for (int i = 0; i < parts && !sender.IsDone(); ++i) {
      static_cast<void>(plans_.Take(sender.Next()));
    }
  }
  void BeginHorizon() {
    ASSERT_FALSE(Tick());
    Answer(PlanToGoal());
    ASSERT_TRUE(Tick());
  }

  trajectory::PlanReceiver plans_;
};

TEST_F(HorizonTest, AsksEvery40MsAndFollowsTheNewest) {
  EXPECT_FALSE(Tick()) << "there is none yet";
  EXPECT_EQ(way_.note.plans_asked, 1);
  EXPECT_EQ(way_.asked_ns, now_ns_);
  Ticks(10);
  EXPECT_EQ(way_.note.plans_asked, 1) << "it waits for the answer";
  Answer(PlanToGoal());
  EXPECT_TRUE(Tick());
  EXPECT_EQ(way_.horizon_ns, way_.asked_ns);
  const std::int64_t first = way_.asked_ns;
  EXPECT_EQ(Ticks(29), 29);
  EXPECT_EQ(way_.note.plans_asked, 2);
  EXPECT_EQ(way_.asked_ns, first + 40 * hal::kNsPerMs);
  EXPECT_EQ(way_.horizon_ns, first) << "the last one is followed until the next is there";
  Answer(PlanToGoal());
  EXPECT_TRUE(Tick());
  EXPECT_EQ(way_.horizon_ns, way_.asked_ns);
  EXPECT_TRUE(events_.empty()) << "horizons come and go without a word";
}

// The reference of the request's tick is the horizon's begin, after that tick.
TEST_F(HorizonTest, StepIsTheHorizonsMotion) {
  BeginHorizon();
  Ticks(30);
  const trajectory::Plan plan = plans_.plan();
  const auto at = [&](std::int64_t ticks) {
    trajectory::Reference reference;
    plan.At(1e-3 * static_cast<double>(ticks), reference);
    return reference;
  };
  const std::int64_t ticks = (now_ns_ - way_.horizon_ns) / hal::kTickPeriodNs;
  reference_ = at(ticks);  // before the next tick moves it
  ASSERT_TRUE(Tick());
  EXPECT_GT(at(ticks + 1).dq.norm(), 1e-3);
  EXPECT_LT((step_.task.v - at(ticks + 1).dq).norm(), 1e-9);
  EXPECT_LT((step_.ddq - at(ticks + 1).ddq).norm(), 1e-9);
}

// A square looks the same after a quarter turn: law and horizon must mean the same goal.
TEST_F(HorizonTest, LawTakesTheHorizonsTurn) {
  EXPECT_FALSE(Tick());
  trajectory::Plan plan = PlanToGoal();
  plan.turn = 3;
  Answer(plan);
  EXPECT_TRUE(Tick());
  EXPECT_EQ(way_.turn, 3);
}

// A plan has led to this one of the equal goals, because the others are not reachable.
TEST_F(HorizonTest, HorizonToAnotherTurnThanThePlansIsNotFollowed) {
  way_.keeps_posture = true;
  way_.turn = 1;
  EXPECT_FALSE(Tick());
  trajectory::Plan plan = PlanToGoal();
  plan.turn = 3;
  Answer(plan);
  EXPECT_FALSE(Tick());
  EXPECT_EQ(way_.turn, 1);
}

// At its goal, or before a limit: the law pushes on, and limits that stop it are noticed.
TEST_F(HorizonTest, HorizonThatHardlyMovesIsLeftToTheLaw) {
  EXPECT_FALSE(Tick());
  VecN near = reference_.q;
  near[2] += 0.004;
  Answer(PlanTo(reference_.q, near));
  EXPECT_EQ(Ticks(30), 0);
  EXPECT_TRUE(events_.empty());
  near[2] += 0.004;
  Ticks(10);
  Answer(PlanTo(reference_.q, near));
  EXPECT_EQ(Ticks(20), 20);
}

TEST_F(HorizonTest, LawBeginsSmoothlyBeforeAHorizon) {
  way_.since_ns = now_ns_;
  config_.law.smooth_start_s = 0.25;
  Ticks(249);
  EXPECT_EQ(way_.note.plans_asked, 0);
  Ticks(2);
  EXPECT_EQ(way_.note.plans_asked, 1);
}

TEST_F(HorizonTest, SlowLawLooksFartherThanAHorizon) {
  config_.law.lambda = 0.4;
  EXPECT_EQ(Ticks(500), 0);
  EXPECT_EQ(way_.note.plans_asked, 0);
}

// ChooseWay has refused it in the same tick.
TEST_F(HorizonTest, RefusedPlanIsNoHorizon) {
  EXPECT_FALSE(Tick());
  Answer(PlanToGoal());
  WaySight sight = Sight();
  sight.is_seen = true;
  sight.has_answer = true;
  way_.asked_ns = -1;
  EXPECT_FALSE(FollowHorizon(config_, sight, plans_, way_, step_));
  EXPECT_EQ(way_.horizon_ns, -1);
}

TEST_F(HorizonTest, PlannerThatDiesLeavesTheLaw) {
  BeginHorizon();
  const int follows = Ticks(1000);
  EXPECT_NEAR(follows, 300, 2) << "300 ms from its begin, and then the law";
  EXPECT_EQ(way_.horizon_ns, -1);
  EXPECT_EQ(events_, std::vector{PlanEvent::kLate}) << "said once";
  EXPECT_FALSE(way_.IsPlannerLate()) << "the next whole plan is waited for as long as ever";
  EXPECT_LT(way_.note.plans_asked, 10) << "it asks on, but less often";
  EXPECT_GT(way_.note.plans_asked, 4);
  Answer(PlanToGoal());
  EXPECT_TRUE(Tick()) << "it is back";
}

TEST_F(HorizonTest, AnswerForATargetThatJumpedIsRefused) {
  EXPECT_FALSE(Tick());
  trajectory::Plan plan = PlanToGoal();
  plan.p_BO[1] += 0.2;
  Answer(plan);
  EXPECT_FALSE(Tick());
  EXPECT_EQ(events_, std::vector{PlanEvent::kStale});
  EXPECT_EQ(Ticks(30), 0) << "once refused, it stays so";
  EXPECT_EQ(events_.size(), 1U);
}

TEST_F(HorizonTest, AnswerForAnotherPlaceOfTheArmIsRefused) {
  EXPECT_FALSE(Tick());
  const trajectory::Plan plan = PlanToGoal();
  reference_.q[3] += 0.1;
  Answer(plan);
  EXPECT_FALSE(Tick());
  EXPECT_EQ(events_, std::vector{PlanEvent::kStale});
}

TEST_F(HorizonTest, AnswerWithoutAMotionLeavesTheLaw) {
  BeginHorizon();
  Ticks(45);
  trajectory::Plan none;
  none.outcome = trajectory::PlanOutcome::kTargetNotInSight;
  none.num_joints = 7;
  none.stamp_ns = way_.asked_ns;
  Answer(none);
  EXPECT_FALSE(Tick());
  EXPECT_EQ(way_.note.outcome, static_cast<std::int32_t>(trajectory::PlanOutcome::kTargetNotInSight));
}

// Only one horizon is stored: while the next one comes in parts, the motion goes on as it is, for 5 ms.
TEST_F(HorizonTest, MotionGoesOnWhileTheNextHorizonComes) {
  BeginHorizon();
  Ticks(45);
  reference_.dq[2] = 0.3;
  reference_.ddq[2] = 2.0;
  Answer(PlanToGoal(), 1);
  ASSERT_TRUE(Tick());
  EXPECT_NEAR(step_.task.v[2], 0.302, 1e-12);
  EXPECT_EQ(step_.ddq[2], 2.0);
  const int asked = way_.note.plans_asked;
  EXPECT_EQ(Ticks(20), 4) << "the rest was lost";
  EXPECT_EQ(way_.horizon_ns, -1);
  EXPECT_EQ(way_.note.plans_asked, asked + 1) << "it is asked for anew at once";
  EXPECT_TRUE(events_.empty());
}

TEST_F(HorizonTest, LawGoesAloneWhileSeveralPosesFit) {
  told_apart_ = false;
  EXPECT_EQ(Ticks(500), 0);
  EXPECT_EQ(way_.note.plans_asked, 0);
}

TEST_F(HorizonTest, MovingTargetIsLeftToTheLaw) {
  v_BO_ = {0.0, 0.1, 0.0};
  EXPECT_EQ(Ticks(500), 0);
  EXPECT_EQ(way_.note.plans_asked, 0);
  v_BO_ = {0.0, 0.04, 0.0};
  BeginHorizon();
}

TEST_F(HorizonTest, OnlyAPredictiveLawAsks) {
  config_.law.law = config::Law::kMean;
  EXPECT_EQ(Ticks(500), 0);
  EXPECT_EQ(way_.note.plans_asked, 0);
  config_.law.law = config::Law::kPredictive;
  way_.note.way = hal::Way::kPlan;
  EXPECT_EQ(Ticks(500), 0);
  EXPECT_EQ(way_.note.plans_asked, 0) << "a plan is under way";
}

TEST_F(HorizonTest, TargetOutOfSightEndsTheHorizon) {
  BeginHorizon();
  is_seen_ = false;
  EXPECT_NEAR(Ticks(1000), 300, 2);
  EXPECT_EQ(way_.note.plans_asked, 1);
}

}  // namespace
}  // namespace fovea::control
