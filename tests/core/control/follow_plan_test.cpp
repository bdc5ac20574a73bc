// SPDX-License-Identifier: Apache-2.0
// The arm on a plan: the end follows the target's estimate, time waits for the arm, and no number is trusted.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "firmware/core/control/count_tick.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "tests/core/control/planned_way.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::control {
namespace {

using hal::PlanEvent;
using hal::Way;

class FollowPlanTest : public PlannedWay {
 protected:
  // How far the camera is from its goal: along and about all axes, 1 rad as 0.1 m.
  [[nodiscard]] double OffGoal() const {
    const model::Pose X_CO = CameraAt(reference_.q).Inverse() * X_BO_;
    const double turn = model::RotationVector(config_.feature.R_CO_star.transpose() * X_CO.R).norm();
    return (X_CO.p - config_.feature.p_CO_C_star).norm() +
           (config_.feature.SeesOrientation() ? 0.1 * turn : 0.0);
  }
  // The target jumps by `d` [m] and turns by `turn_B` [rad] about its own centre.
  void MoveTarget(const model::Vec3& d, const model::Vec3& turn_B) {
    X_BO_.p += d;
    X_BO_.R = model::RotationOf(turn_B) * X_BO_.R;
  }
};

TEST_F(FollowPlanTest, PlanIsFollowedExactlyInItsTime) {
  BeginPlan();
  trajectory::Reference at;
  int ticks = 0;
  for (; way_.note.way == Way::kPlan && ticks < 5000; ++ticks) {
    Follow();
    plan_.At(way_.t, at);
    EXPECT_LT((at.q - reference_.q).lpNorm<Eigen::Infinity>(), 2e-3);
    EXPECT_LT((at.dq - reference_.dq).lpNorm<Eigen::Infinity>(), 2e-2);
    EXPECT_EQ((at.ddq - step_.ddq).norm(), 0.0);
    EXPECT_TRUE(step_.task.J.isIdentity(0.0) && step_.task.dq_0.isZero(0.0));
    Choose();
  }
  EXPECT_NEAR(ticks, 1e3 * plan_.Duration(), 2.0);
  EXPECT_EQ(events_.back(), PlanEvent::kDone);
}

// The joints' path then ends where the camera reaches the moved goal: checked by the arm's kinematics. The
// shift is linear in the target's motion, so that the share that is left shrinks with it.
TEST_F(FollowPlanTest, EndOfThePlanFollowsTheTarget) {
  test::RandomStates random(51);
  for (const double size : {1.0, 0.1}) {
    double worst = 0.0;
    for (int k = 0; k < 40; ++k) {
      way_ = WayToGoal{};
      q_goal_ = test::Ready() + random.Joints(config_.arm, 0.15);
      q_goal_[0] += k % 2 == 0 ? 0.9 : -0.9;
      PutTargetFor(q_goal_);
      StandAt(test::Ready());
      BeginPlan();
      FollowFor(static_cast<int>(random.Uniform(1.0, 1000.0)));
      MoveTarget(size * random.Vector(0.02), size * random.Vector(0.05));
      const trajectory::Reference here = reference_;
      StandAt(q_goal_);
      const double moved = OffGoal();
      reference_ = here;
      ASSERT_EQ(FollowOn(), PlanEvent::kDone) << k;
      worst = std::max(worst, (OffGoal() - 1e-4) / moved);
    }
    std::printf("left at the end: %.3f of the target's motion\n", worst);
    EXPECT_LT(worst, 0.25 * size);
  }
}

TEST_F(FollowPlanTest, EndOfThePlanFollowsABallWithoutTurning) {
  config_.feature = features::TargetFeature{};
  q_goal_[5] += 0.2;
  PutTargetFor(q_goal_);
  BeginPlan();
  FollowFor(500);
  MoveTarget({0.02, -0.03, 0.01}, {0.0, 0.0, 0.0});
  X_BO_.R = model::RotationOf(model::Vec3(1.0, 2.0, 0.5));  // means nothing
  ASSERT_EQ(FollowOn(), PlanEvent::kDone);
  EXPECT_LT(OffGoal(), 0.15 * 0.037);
  const model::Mat3 R = CameraAt(reference_.q).R.transpose() * CameraAt(q_goal_).R;
  EXPECT_LT(model::RotationVector(R).norm(), 0.01);
}

TEST_F(FollowPlanTest, JumpOfTheEstimateMakesNoJumpOfTheWish) {
  BeginPlan();
  double most = 0.0;
  model::VecN v_before = model::VecN::Zero(7);
  for (int i = 0; way_.note.way == Way::kPlan && i < 5000; ++i) {
    if (i == 900) {
      MoveTarget({0.04, 0.0, -0.02}, {0.05, 0.0, 0.05});
    }
    Follow();
    most = std::max(most, (step_.task.v - v_before).lpNorm<Eigen::Infinity>());
    v_before = step_.task.v;
    Choose();
  }
  EXPECT_EQ(events_.back(), PlanEvent::kDone);
  EXPECT_LT(most, 0.05);
}

// A joint that a barrier has pushed off the plan goes back no faster than the guard's braking can stop it
// there.
TEST_F(FollowPlanTest, JointFarOffThePlanComesBackNoFasterThanItCanStop) {
  for (const double off : {0.03, 0.1, 0.2}) {
    BeginPlan();
    FollowFor(300);
    const double most = trajectory::PaceOf(config_, 1).ddq_max * hal::kTickPeriodS;
    reference_.q[1] += off;
    reference_.dq[1] = 0.0;
    const double braking = trajectory::PaceOf(config_, 1).deceleration;
    double beyond = -HUGE_VAL;  // how far past the plan it would stop [rad]
    int ticks = 0;
    trajectory::Reference at;
    plan_.At(way_.t, at);
    while (ticks < 1500 && std::fabs(at.q[1] - reference_.q[1]) > 1e-3) {
      ++ticks;
      FollowPlan(config_, plan_, reference_, is_seen_, way_, step_);
      // As fast as its acceleration allows.
      const double dq = reference_.dq[1] + std::clamp(step_.task.v[1] - reference_.dq[1], -most, most);
      reference_.dq = step_.task.v;
      reference_.dq[1] = dq;
      reference_.q += hal::kTickPeriodS * reference_.dq;
      plan_.At(way_.t, at);
      const double back = std::max(-dq, 0.0);
      beyond = std::max(beyond, back * back / (2.0 * braking) - (reference_.q[1] - at.q[1]));
    }
    std::printf("%.2f rad off: back after %d ms, would stop %.4f rad past the plan at most\n", off, ticks,
                beyond);
    EXPECT_LT(ticks, 1000);
    EXPECT_LT(beyond, 2e-3);
    StandAt(test::Ready());
    way_ = WayToGoal{};
  }
}

// A plan that uses 95 % of a joint's acceleration leaves little for a pace that rises.
TEST_F(FollowPlanTest, PaceThatRisesAsksForNoMoreAccelerationThanThereIs) {
  BeginPlan();
  double most = 0.0;
  trajectory::Reference at;
  for (int i = 0; i * hal::kTickPeriodS < plan_.Duration(); ++i) {
    plan_.At(i * hal::kTickPeriodS, at);
    most = std::max(most, std::fabs(at.ddq[0]));
  }
  config_.arm.joints[0].ddq_max *= most / 0.95 / trajectory::PaceOf(config_, 0).ddq_max;
  const double limit = trajectory::PaceOf(config_, 0).ddq_max;
  for (const int tick : {200, 400, 600, 900}) {  // from which the eye is trusted
    StandAt(test::Ready());
    way_ = WayToGoal{};
    BeginPlan();
    way_.trust = 0.0;
    is_eye_trusted_ = false;
    double used = 0.0;
    double before = 0.0;
    for (int i = 0; way_.note.way == Way::kPlan && i < 5000; ++i) {
      is_eye_trusted_ = i >= tick;
      Follow();
      used = std::max(used, std::fabs(step_.task.v[0] - before) / hal::kTickPeriodS / limit);
      before = step_.task.v[0];
      Choose();
    }
    EXPECT_EQ(events_.back(), PlanEvent::kDone);
    std::printf("trusted after %d ms: %.3f of the acceleration's limit\n", tick, used);
    EXPECT_LT(used, 1.02);
  }
}

TEST_F(FollowPlanTest, TargetThatIsElsewhereNeedsANewPlan) {
  const model::Vec3 far[] = {{0.2, 0.0, 0.0}, {0.0, 0.0, -0.2}, {0.0, 0.0, 0.0}};
  const model::Vec3 turned[] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.6}};
  for (int k = 0; k < 3; ++k) {
    way_ = WayToGoal{};
    PutTargetFor(q_goal_);
    StandAt(test::Ready());
    BeginPlan();
    FollowFor(400);
    MoveTarget(far[k], turned[k]);
    EXPECT_EQ(Choose(), PlanEvent::kTargetMoved) << k;
    EXPECT_EQ(way_.note.way, Way::kAwaitPlan);
    Choose(100);
    EXPECT_EQ(way_.note.plans_asked, 1) << "the arm still moves";
    StandAt(reference_.q);
    EXPECT_EQ(Choose(), PlanEvent::kAsked);
    EXPECT_EQ(way_.note.tries, 2);
  }
}

// The first new plan is asked for at once, further ones one second apart: between them the law goes on.
TEST_F(FollowPlanTest, TargetThatKeepsJumpingGetsOneNewPlanASecond) {
  BeginPlan();
  const std::int64_t begin_ns = now_ns_;
  std::vector<std::int64_t> asked_ns;
  for (int i = 0; i < 4000; ++i) {
    if (i % 200 == 100) {
      MoveTarget({i % 400 == 100 ? 0.15 : -0.15, 0.0, 0.0}, {0.0, 0.0, 0.0});
    }
    if (way_.note.way == Way::kPlan) {
      Follow();
    } else {
      StandAt(reference_.q);
    }
    if (Choose() == PlanEvent::kAsked) {
      asked_ns.push_back(now_ns_);
      ASSERT_EQ(Answer(PlanToGoal()), PlanEvent::kTaken);
    }
  }
  ASSERT_GE(asked_ns.size(), 4U);
  EXPECT_LT(asked_ns[0] - begin_ns, 110 * hal::kTickPeriodNs);
  for (std::size_t i = 1; i < asked_ns.size(); ++i) {
    EXPECT_GE(asked_ns[i] - asked_ns[i - 1], hal::kNsPerSecond - hal::kTickPeriodNs) << i;
  }
}

TEST_F(FollowPlanTest, TargetThatMovedAndRestsAgainGetsANewPlan) {
  BeginPlan();
  FollowFor(400);
  MoveTarget({0.2, 0.0, 0.0}, {0.0, 0.0, 0.0});
  v_BO_ = {0.2, 0.0, 0.0};
  EXPECT_EQ(Choose(), PlanEvent::kTargetMoved);
  Choose(500);
  EXPECT_EQ(way_.note.way, Way::kLaw) << "it follows a moving target";
  EXPECT_EQ(way_.note.plans_asked, 1);
  v_BO_.setZero();
  StandAt(reference_.q);
  AskForPlan();
  EXPECT_EQ(way_.note.plans_asked, 2);
}

TEST_F(FollowPlanTest, SlowMotionOfTheTargetAddsUp) {
  BeginPlan();
  PlanEvent event = PlanEvent::kNone;
  int ticks = 0;
  for (; event == PlanEvent::kNone && ticks < 1500; ++ticks) {
    X_BO_.p.z() += 2e-4;
    Follow();
    event = Choose();
  }
  EXPECT_EQ(event, PlanEvent::kTargetMoved);
  EXPECT_GT(ticks * 2e-4, 0.03);
  EXPECT_LT(ticks * 2e-4, 0.15);
}

TEST_F(FollowPlanTest, TimeWaitsForAnArmThatLimitsHoldUp) {
  BeginPlan();
  FollowFor(600);
  EXPECT_FALSE(IsHeldUp(way_));
  trajectory::Reference at;
  for (int i = 0; i < 250; ++i) {
    Follow(true);
    plan_.At(way_.t, at);
    EXPECT_LT((at.q - reference_.q).lpNorm<Eigen::Infinity>(), 0.05);
    ASSERT_EQ(Choose(), PlanEvent::kNone);
  }
  EXPECT_TRUE(IsHeldUp(way_));
  EXPECT_EQ(FollowOn(), PlanEvent::kDone) << "a short stop needs no new plan";
  EXPECT_LT((reference_.q - q_goal_).lpNorm<Eigen::Infinity>(), 1e-4);
}

TEST_F(FollowPlanTest, ArmThatStaysHeldUpGetsANewPlan) {
  BeginPlan();
  FollowFor(600);
  int ticks = 0;
  for (PlanEvent event = PlanEvent::kNone; event == PlanEvent::kNone && ticks < 5000; ++ticks) {
    Follow(true);
    event = Choose();
  }
  EXPECT_EQ(events_.back(), PlanEvent::kHeld);
  EXPECT_GT(ticks, 300);
  EXPECT_LT(ticks, 700);
  EXPECT_EQ(way_.note.way, Way::kAwaitPlan);
  EXPECT_FALSE(IsHeldUp(way_));
  StandAt(reference_.q);
  EXPECT_EQ(Choose(), PlanEvent::kAsked);
}

// An estimate that is not finite, in each way: nothing of it stays, and the wish is finite.
TEST_F(FollowPlanTest, EstimateThatIsNotFiniteChangesNothingForGood) {
  const double bad[] = {std::nan(""), std::numeric_limits<double>::infinity(), 1e308, -1e308};
  for (const double value : bad) {
    for (int entry = 0; entry < 12; ++entry) {
      for (const Way from : {Way::kLaw, Way::kAwaitPlan, Way::kPlan}) {
        way_ = WayToGoal{};
        PutTargetFor(q_goal_);
        StandAt(test::Ready());
        if (from == Way::kAwaitPlan) {
          AskForPlan();
        } else if (from == Way::kPlan) {
          BeginPlan();
          FollowFor(300);
        }
        const model::Pose X_BO = X_BO_;
        (entry < 3 ? X_BO_.p[entry] : X_BO_.R.data()[entry - 3]) = value;
        for (int i = 0; i < 20; ++i) {
          Choose(from == Way::kAwaitPlan);
          if (way_.note.way == Way::kPlan) {
            Follow();
            ASSERT_TRUE(step_.task.v.allFinite() && step_.ddq.allFinite());
          }
        }
        ASSERT_TRUE(way_.shift.allFinite() && reference_.q.allFinite() && std::isfinite(way_.t));
        X_BO_ = X_BO;
        StandAt(reference_.q);
        way_.note.tries = 0;
        way_.is_fresh = way_.note.way == Way::kLaw;
        if (way_.note.way == Way::kLaw) {
          AskForPlan();
        }
      }
    }
  }
}

TEST_F(FollowPlanTest, TimeThatTicksCountIsNeverNegative) {
  std::int64_t ns = 0;
  CountTick(false, ns);
  EXPECT_EQ(ns, 0);
  CountTick(true, ns);
  CountTick(true, ns);
  EXPECT_EQ(ns, 2 * hal::kTickPeriodNs);
  CountTick(false, ns);
  EXPECT_EQ(ns, hal::kTickPeriodNs);
}

}  // namespace
}  // namespace fovea::control
