// SPDX-License-Identifier: Apache-2.0
// Plans beside the tick that do not come, come late, or are for a target that moves on: the servo says so,
// and reaches the goal. Measurements are the truth plus 0.05 px of noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/closed_loop/closed_loop.hpp"
#include "tests/closed_loop/truth_run.hpp"

namespace fovea::test {
namespace {

using hal::PlanEvent;
using Assignments = std::vector<std::string>;

class Plans : public testing::Test {
 protected:
  void Run(const std::string& scenario, const Assignments& assignments) {
    TruthRun run(scenario, assignments, 0.05);
    summary_ = run.Execute();
    plans_ = run.plans();
    PrintResidual(summary_);
    for (const auto& [t_s, event] : plans_) {
      std::cout << "  " << t_s << " s: " << hal::Name(event) << '\n';
    }
    EXPECT_TRUE(summary_.converged) << summary_.verdict;
    EXPECT_EQ(summary_.limit_violations, 0U);
    EXPECT_TRUE(summary_.faults.empty());
  }
  [[nodiscard]] int Count(PlanEvent event) const {
    return static_cast<int>(
        std::count_if(plans_.begin(), plans_.end(), [&](const auto& at) { return at.second == event; }));
  }
  // The time of the first `event` [s]; -1: none.
  [[nodiscard]] double First(PlanEvent event) const {
    const auto found =
        std::find_if(plans_.begin(), plans_.end(), [&](const auto& at) { return at.second == event; });
    return found == plans_.end() ? -1.0 : found->first;
  }

  sim::Summary summary_;
  std::vector<std::pair<double, PlanEvent>> plans_;
};

// A target that jumps in the middle of the first planned way, which takes a second.
Assignments JumpAt(const char* time_s, const char* jump = "[0, 0.1, 0]") {
  return {"target.motion=jump", std::string("target.jump=") + jump, std::string("target.jump_s=") + time_s};
}
Assignments With(Assignments all, const std::string& more) {
  all.push_back(more);
  return all;
}

class DeadPlanner : public Plans, public testing::WithParamInterface<const char*> {};

TEST_P(DeadPlanner, LawGoesAloneFromTheStart) {
  Run(GetParam(), {"faults.planner_loss_s=[0, 1e6]"});
  EXPECT_EQ(Count(PlanEvent::kTaken), 0);
  EXPECT_GE(Count(PlanEvent::kLate), 1);
  EXPECT_NEAR(First(PlanEvent::kLate) - First(PlanEvent::kAsked), 2.0, 0.01);
  ASSERT_EQ(summary_.injected.size(), 1U);
  EXPECT_NEAR(summary_.injected[0].noticed["plan_late"], First(PlanEvent::kLate), 0.01);
}
INSTANTIATE_TEST_SUITE_P(Scenarios, DeadPlanner, testing::Values("ball", "square", "circle", "triangle"),
                         [](const auto& c) { return std::string(c.param); });

// The plan is there already, and is followed to its end.
TEST_F(Plans, PlannerThatDiesOnTheWayIsNotMissed) {
  Run("square", {"faults.planner_loss_s=[0.5, 1e6]"});
  EXPECT_EQ(Count(PlanEvent::kAsked), 1);
  EXPECT_EQ(Count(PlanEvent::kDone), 1);
  EXPECT_TRUE(summary_.injected.at(0).noticed.count("plan_late") == 0);
}

// The target jumps on the way: the plan is dropped, and the law goes on to the new goal.
TEST_F(Plans, PlannerThatDiesOnTheWayLeavesTheLaw) {
  Run("square", With(JumpAt("0.6"), "faults.planner_loss_s=[0.5, 1e6]"));
  EXPECT_EQ(Count(PlanEvent::kTargetMoved), 1);
  EXPECT_EQ(Count(PlanEvent::kTaken), 1);
  EXPECT_EQ(Count(PlanEvent::kLate), 1);
}

// The fault ends, and a later goal is planned for again.
TEST_F(Plans, PlannerThatComesBackIsUsedAgain) {
  Run("ball", With(With(JumpAt("5", "[0.1, 0.1, 0]"), "faults.planner_loss_s=[0, 3]"), "run.duration_s=10"));
  EXPECT_EQ(Count(PlanEvent::kLate), 1);
  EXPECT_GE(Count(PlanEvent::kTaken), 1);
  EXPECT_GT(First(PlanEvent::kTaken), 5.0);
}

// The planner is starved while the target jumps: what it then sends is for the place that the target has
// left.
TEST_F(Plans, LatePlanForATargetThatHasJumpedIsRefused) {
  Run("square", With(JumpAt("0.6"), "faults.planner_loss_s=[0, 1.2]"));
  EXPECT_EQ(Count(PlanEvent::kLate), 0);
  EXPECT_EQ(Count(PlanEvent::kStale), 1);
  EXPECT_GT(First(PlanEvent::kStale), 1.2);
  EXPECT_EQ(Count(PlanEvent::kTaken), 0) << "the law goes on to the new goal, which is near";
}

// From this start the visual law ends at a limit (four_targets_test.cpp). The target jumps on the planned
// way.
TEST_F(Plans, TargetThatJumpsOnTheWayGetsANewPlan) {
  const Assignments start{"arm.q_start=[-0.1256,1.1934,-2.1153,-1.6094,0.3756,1.2153,-2.4184]",
                          "target.position=[-0.3945,-0.3287,0.0338]",
                          "target.rpy_deg=[-155.83,2.12,67.80]",
                          "target.motion=jump",
                          "target.jump=[0, 0.1, 0]",
                          "target.jump_s=1"};
  Run("triangle", start);
  EXPECT_GE(Count(PlanEvent::kTargetMoved), 1);
  EXPECT_GE(Count(PlanEvent::kTaken), 2);
}

// A target at 5 cm/s, which a plan's end follows for 8 cm, and one slightly slower.
class SlowTarget : public Plans, public testing::WithParamInterface<std::tuple<const char*, const char*>> {};

TEST_P(SlowTarget, IsReachedAndFollowed) {
  const auto& [scenario, speed] = GetParam();
  Run(scenario, {"target.motion=circle", "target.path_radius=0.1", std::string("target.speed=") + speed,
                 "run.duration_s=10", "run.tracking_bound_px=5"});
  double last_s = -10.0;
  for (const auto& [t_s, event] : plans_) {
    if (event == PlanEvent::kAsked && last_s > 0.0) {
      EXPECT_GT(t_s - last_s, 0.9) << "new plans come at most once a second";
    }
    last_s = event == PlanEvent::kAsked ? t_s : last_s;
  }
}
INSTANTIATE_TEST_SUITE_P(Runs, SlowTarget,
                         testing::Combine(testing::Values("ball", "square"),
                                          testing::Values("0.05", "0.04")));

}  // namespace
}  // namespace fovea::test
