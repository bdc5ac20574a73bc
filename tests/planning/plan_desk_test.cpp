// SPDX-License-Identifier: Apache-2.0
// The planner's desk: at real pace on its own thread, in lockstep at modelled times.
#include "firmware/planning/plan_desk.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "tests/planning/starts.hpp"

namespace fovea::planning {
namespace {

using trajectory::Plan;
using namespace std::chrono_literals;

class PlanDeskTest : public testing::Test {
 protected:
  PlanDeskTest() : config_(test::PlannedServo("panda", "square")), starts_(config_, 3) {}

  // The record of a tick that asks for a plan from a random start.
  hal::TickRecord Request(std::int64_t stamp_ns, int number = 1) {
    const trajectory::PlanRequest start = starts_.Next();
    hal::TickRecord record;
    record.stamp_ns = stamp_ns;
    record.command.num_joints = config_.arm.num_joints;
    record.q_cmd = model::ToArray(start.start.q);
    record.p_BO = {start.X_BO.p.x(), start.X_BO.p.y(), start.X_BO.p.z()};
    record.q_BO = model::QuaternionOf(start.X_BO.R);
    record.way.way = hal::Way::kAwaitPlan;
    record.way.plans_asked = number;
    record.way.tries = 1;
    return record;
  }
  // Up to 20 s of waiting.
  static bool Await(PlanDesk& desk, Plan& plan) {
    for (int i = 0; i < 20'000; ++i) {
      if (desk.box().plans.Take(plan)) {
        return true;
      }
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  // In lockstep from `begin_ns`: the tick in which the answer comes, -1: none in 5 s.
  static int AwaitInLockstep(PlanDesk& desk, std::int64_t begin_ns, Plan& plan) {
    for (int tick = 0; tick < 5000; ++tick) {
      desk.Act(begin_ns + tick * hal::kTickPeriodNs);
      if (desk.box().plans.Take(plan)) {
        return tick;
      }
    }
    return -1;
  }
  static bool AreSame(const Plan& a, const Plan& b) {
    return a.outcome == b.outcome && a.num_points == b.num_points && a.turn == b.turn &&
           a.stamp_ns == b.stamp_ns && a.period_s == b.period_s &&
           std::memcmp(a.points.data(), b.points.data(), sizeof(a.points)) == 0;
  }

  config::ServoConfig config_;
  test::PlannedStarts starts_;
};

TEST_F(PlanDeskTest, ThreadAnswersEachRequestAsThePlannerAlone) {
  const auto desk = std::make_unique<PlanDesk>(config_);
  Planner alone(config_);
  desk->Begin();
  int found = 0;
  for (int k = 1; k <= 4; ++k) {
    const hal::TickRecord record = Request(1000 * k, k);
    desk->box().requests.Put(record);
    Plan plan;
    Plan expected;
    ASSERT_TRUE(Await(*desk, plan)) << k;
    alone.Compute(trajectory::RequestOf(record), expected);
    EXPECT_EQ(plan.stamp_ns, record.stamp_ns);
    EXPECT_TRUE(AreSame(plan, expected)) << k;
    found += plan.IsFound() ? 1 : 0;
  }
  EXPECT_GT(found, 0);
  Plan none;
  EXPECT_FALSE(desk->box().plans.Take(none)) << "one answer for a request";
}

TEST_F(PlanDeskTest, ThreadEndsInBoundedTime) {
  const auto begun = std::chrono::steady_clock::now();
  {
    PlanDesk never(config_);
    never.End();
  }
  {
    PlanDesk idle(config_);
    idle.Begin();
  }
  PlanDesk desk(config_);
  for (int k = 1; k <= 3; ++k) {
    desk.Begin();
    desk.box().requests.Put(Request(k, k));
    std::this_thread::sleep_for(3ms);
    desk.End();  // in the middle of its work: that ends first
    desk.End();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 60s);
}

TEST_F(PlanDeskTest, LockstepAnswersAtTheSameModelledTime) {
  const hal::TickRecord record = Request(5'000'000, 1);
  std::array<Plan, 2> plans;
  std::array<int, 2> ticks{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto desk = std::make_unique<PlanDesk>(config_);
    Plan before;
    EXPECT_EQ(AwaitInLockstep(*desk, 0, before), -1) << "nothing was asked";
    desk->box().requests.Put(record);
    ticks[i] = AwaitInLockstep(*desk, record.stamp_ns, plans[i]);
    ASSERT_GE(ticks[i], 0);
    EXPECT_EQ(AwaitInLockstep(*desk, record.stamp_ns, before), -1) << "one answer for a request";
  }
  EXPECT_EQ(ticks[0], ticks[1]);
  EXPECT_TRUE(AreSame(plans[0], plans[1]));
  Planner alone(config_);
  Plan expected;
  alone.Compute(trajectory::RequestOf(record), expected);
  EXPECT_TRUE(AreSame(plans[0], expected));
  const std::int64_t due_ns = PlanDesk::ModelledNs(alone.effort().work);
  EXPECT_EQ(ticks[0], (due_ns + hal::kTickPeriodNs - 1) / hal::kTickPeriodNs);
  EXPECT_GT(PlanDesk::ModelledNs(100'000), PlanDesk::ModelledNs(0) + 50'000'000);
  EXPECT_GT(PlanDesk::ModelledNs(0), 0);
}

TEST_F(PlanDeskTest, NewestRequestWins) {
  const auto desk = std::make_unique<PlanDesk>(config_);
  desk->box().requests.Put(Request(1'000'000, 1));
  desk->box().requests.Put(Request(2'000'000, 2));
  Plan plan;
  ASSERT_GE(AwaitInLockstep(*desk, 3'000'000, plan), 0);
  EXPECT_EQ(plan.stamp_ns, 2'000'000);
  // A request that comes while an answer waits for its time replaces it.
  desk->box().requests.Put(Request(4'000'000, 3));
  desk->Act(4'000'000);
  desk->box().requests.Put(Request(5'000'000, 4));
  ASSERT_GE(AwaitInLockstep(*desk, 5'000'000, plan), 0);
  EXPECT_EQ(plan.stamp_ns, 5'000'000);
  EXPECT_EQ(AwaitInLockstep(*desk, 3'000'000'000, plan), -1);
}

TEST_F(PlanDeskTest, RequestThatIsNotFiniteHasAnAnswer) {
  const auto desk = std::make_unique<PlanDesk>(config_);
  hal::TickRecord record = Request(1'000'000, 1);
  record.p_BO[1] = std::nan("");
  desk->box().requests.Put(record);
  Plan plan;
  ASSERT_GE(AwaitInLockstep(*desk, record.stamp_ns, plan), 0);
  EXPECT_EQ(plan.outcome, trajectory::PlanOutcome::kBadRequest);
  EXPECT_EQ(plan.stamp_ns, 1'000'000);
}

}  // namespace
}  // namespace fovea::planning
