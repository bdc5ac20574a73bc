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

// With a high gain the scenario's law is as quick for a ball, whose error falls in a straight line, and
// slower for the others.
TEST_P(PredictiveScenario, IsNotSlowerThanTheLawWithAHighGain) {
  const Assignments gain{"servo.plans=false", "servo.lambda=6", "servo.lambda_near=0"};
  Assignments predictive = gain;
  predictive.emplace_back(kPredictive);
  const sim::Summary law = Run(GetParam(), gain);
  const sim::Summary ahead = Run(GetParam(), predictive);
  EXPECT_TRUE(ahead.converged) << ahead.verdict;
  ASSERT_TRUE(ahead.settle_time_s.has_value());
  EXPECT_LT(*ahead.settle_time_s, 1.05 * law.settle_time_s.value_or(1e9));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, PredictiveScenario, testing::Values("ball", "square", "circle"),
                         [](const auto& c) { return std::string(c.param); });

TEST_F(Predictive, FollowsAMovingBallAsTheLawDoes) {
  const sim::Summary law = Run("ball-moving", {});
  const sim::Summary ahead = Run("ball-moving", {kPredictive});
  ASSERT_TRUE(law.tracking_error_px_rms.has_value());
  ASSERT_TRUE(ahead.tracking_error_px_rms.has_value());
  EXPECT_LT(*ahead.tracking_error_px_rms, 1.5 * *law.tracking_error_px_rms);
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

TEST_F(Predictive, TargetThatJumpsIsReached) {
  const sim::Summary summary = Run("square", {kPredictive, "servo.plans=false", "target.motion=jump",
                                              "target.jump=[0, 0.1, 0]", "target.jump_s=0.6"});
  EXPECT_TRUE(summary.converged) << summary.verdict;
}

}  // namespace
}  // namespace fovea::test
