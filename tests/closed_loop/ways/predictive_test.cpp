// SPDX-License-Identifier: Apache-2.0
// The predictive law in whole runs: it reaches its goals along horizons, and without its planner, too.
// Measurements are the truth plus 0.05 px of noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/closed_loop/closed_loop.hpp"
#include "tests/closed_loop/truth_run.hpp"

namespace fovea::test {
namespace {

using hal::PlanEvent;
using Assignments = std::vector<std::string>;

constexpr const char* kPredictive = "servo.law=predictive";

class Predictive : public testing::Test {
 protected:
  sim::Summary Run(const std::string& scenario, Assignments assignments) {
    TruthRun run(scenario, assignments, 0.05);
    sim::Summary summary = run.Execute();
    plans_ = run.plans();
    PrintResidual(summary);
    EXPECT_EQ(summary.limit_violations, 0U);
    EXPECT_EQ(summary.contact_ticks, 0U);
    EXPECT_TRUE(summary.faults.empty());
    return summary;
  }
  [[nodiscard]] int Count(PlanEvent event) const {
    return static_cast<int>(
        std::count_if(plans_.begin(), plans_.end(), [&](const auto& at) { return at.second == event; }));
  }

  std::vector<std::pair<double, PlanEvent>> plans_;
};

class PredictiveScenario : public Predictive, public testing::WithParamInterface<const char*> {};

TEST_P(PredictiveScenario, ReachesItsGoalAlone) {
  const sim::Summary summary = Run(GetParam(), {kPredictive, "servo.plans=false"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
  EXPECT_TRUE(plans_.empty()) << "every horizon came in time";
}

TEST_P(PredictiveScenario, ReachesItsGoalBesidePlans) {
  const sim::Summary summary = Run(GetParam(), {kPredictive});
  EXPECT_TRUE(summary.converged) << summary.verdict;
  EXPECT_EQ(Count(PlanEvent::kTaken), 1);
}

// With a high gain a horizon uses the joints' accelerations better than the scenario's law. Not for a ball,
// whose error falls in a straight line.
TEST_P(PredictiveScenario, IsQuickWithAHighGain) {
  const Assignments gain{"servo.plans=false", "servo.lambda=6", "servo.lambda_near=0"};
  Assignments predictive = gain;
  predictive.emplace_back(kPredictive);
  const sim::Summary law = Run(GetParam(), gain);
  const sim::Summary ahead = Run(GetParam(), predictive);
  EXPECT_TRUE(ahead.converged) << ahead.verdict;
  ASSERT_TRUE(ahead.settle_time_s.has_value());
  const double most = std::string(GetParam()) == "ball" ? 1.15 : 1.0;
  EXPECT_LT(*ahead.settle_time_s, most * law.settle_time_s.value_or(1e9));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, PredictiveScenario, testing::Values("ball", "square", "circle"),
                         [](const auto& c) { return std::string(c.param); });

TEST_F(Predictive, FollowsAMovingBallAsTheLawDoes) {
  const sim::Summary law = Run("ball-moving", {});
  const sim::Summary ahead = Run("ball-moving", {kPredictive});
  ASSERT_TRUE(law.tracking_error_px_rms.has_value());
  ASSERT_TRUE(ahead.tracking_error_px_rms.has_value());
  EXPECT_LT(*ahead.tracking_error_px_rms, 1.05 * *law.tracking_error_px_rms);
}

TEST_F(Predictive, DeadPlannerLeavesTheLaw) {
  const sim::Summary summary =
      Run("square", {kPredictive, "servo.plans=false", "faults.planner_loss_s=[0, 1e6]"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
  EXPECT_EQ(plans_.size(), 1U);
  EXPECT_EQ(Count(PlanEvent::kLate), 1);
}

TEST_F(Predictive, PlannerThatComesAndGoesDoesNotThrowTheArm) {
  const sim::Summary summary =
      Run("square", {kPredictive, "servo.plans=false", "faults.planner_loss_s=[0.5, 0.9]"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
  EXPECT_EQ(Count(PlanEvent::kLate), 1);
}

// A plane leaves no room for the hand at the goal: the horizon stops before it, and the servo has to find
// out.
TEST_F(Predictive, GoalThatCannotBeReachedIsNoticed) {
  for (const char* plans : {"servo.plans=false", "servo.plans=true"}) {
    const sim::Summary summary =
        Run("square", {kPredictive, plans, "safety.planes=[0,0,1,0.4]", "run.duration_s=15"});
    EXPECT_FALSE(summary.converged);
    EXPECT_EQ(LastMode(summary), "hold") << plans;
    EXPECT_EQ(LastReason(summary), "goal_unreachable") << plans;
  }
}

// The goal is 1 mm from where the hand may be: no margin of the horizon's own keeps the arm away.
TEST_F(Predictive, GoalBesideALimitIsReached) {
  const sim::Summary summary =
      Run("square", {kPredictive, "servo.plans=false", "safety.planes=[0,0,1,0.38]", "run.duration_s=12"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
}

TEST_F(Predictive, LowGainIsSlowButSteady) {
  for (const char* gain : {"servo.lambda=0.001", "servo.lambda=0.3", "servo.lambda=0.6"}) {
    const sim::Summary law = Run("ball", {"servo.plans=false", gain, "run.duration_s=4"});
    const sim::Summary ahead = Run("ball", {kPredictive, "servo.plans=false", gain, "run.duration_s=4"});
    EXPECT_EQ(LastMode(ahead), "track");
    EXPECT_LT(ahead.final_error_mm.value_or(1e9), 1.1 * law.final_error_mm.value_or(0.0)) << gain;
  }
}

TEST_F(Predictive, TargetThatJumpsIsReached) {
  const sim::Summary summary = Run("square", {kPredictive, "servo.plans=false", "target.motion=jump",
                                              "target.jump=[0, 0.1, 0]", "target.jump_s=0.6"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
}

}  // namespace
}  // namespace fovea::test
