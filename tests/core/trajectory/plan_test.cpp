// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <string>

#include "tests/support/random_states.hpp"

namespace fovea::trajectory {
namespace {

constexpr int kJoints = 7;
constexpr double kPeriodS = 0.03;

// Random control points that are at rest at both ends.
Plan RandomPlan(test::RandomStates& random, int points) {
  Plan plan;
  plan.outcome = PlanOutcome::kFound;
  plan.num_joints = kJoints;
  plan.num_points = points;
  plan.period_s = kPeriodS;
  for (int j = 0; j < kJoints; ++j) {
    for (int i = 0; i < points; ++i) {
      const bool rests = i == 1 || i == 2 || i >= points - 2;
      plan.points[static_cast<std::size_t>(i * kJoints + j)] =
          rests ? plan.Point(i - 1, j) : random.Uniform(-3.0, 3.0);
    }
  }
  return plan;
}

TEST(PlanTest, VelocityAndAccelerationAreThePositionsDerivatives) {
  test::RandomStates random(3);
  const Plan plan = RandomPlan(random, 40);
  constexpr double kStep = 1e-6;
  double off = 0.0;
  Reference at;
  Reference before;
  Reference after;
  for (int k = 0; k < 2000; ++k) {
    const double t = random.Uniform(kStep, plan.Duration() - kStep);
    plan.At(t, at);
    plan.At(t - kStep, before);
    plan.At(t + kStep, after);
    const model::VecN dq = (after.q - before.q) / (2.0 * kStep);
    const model::VecN ddq = (after.dq - before.dq) / (2.0 * kStep);
    off = std::max({off, (dq - at.dq).lpNorm<Eigen::Infinity>() / 100.0,
                    (ddq - at.ddq).lpNorm<Eigen::Infinity>() / 1e4});
  }
  std::printf("off by %.1e of the largest rates\n", off);
  EXPECT_LT(off, 1e-7);
}

TEST(PlanTest, RatesAreWithinTheDifferencesOfTheControlPoints) {
  test::RandomStates random(4);
  const Plan plan = RandomPlan(random, 60);
  double v_max = 0.0;
  double a_max = 0.0;
  double j_max = 0.0;
  for (int j = 0; j < kJoints; ++j) {
    for (int i = 3; i < plan.num_points; ++i) {
      const double step = plan.Point(i, j) - plan.Point(i - 1, j);
      const double second = step - (plan.Point(i - 1, j) - plan.Point(i - 2, j));
      const double third =
          second - (plan.Point(i - 1, j) - 2.0 * plan.Point(i - 2, j) + plan.Point(i - 3, j));
      v_max = std::max(v_max, std::fabs(step) / kPeriodS);
      a_max = std::max(a_max, std::fabs(second) / (kPeriodS * kPeriodS));
      j_max = std::max(j_max, std::fabs(third) / (kPeriodS * kPeriodS * kPeriodS));
    }
  }
  Reference last;
  Reference at;
  plan.At(0.0, last);
  double jerk = 0.0;
  for (int tick = 1; tick * 1e-3 <= plan.Duration(); ++tick) {
    plan.At(tick * 1e-3, at);
    EXPECT_LE(at.dq.lpNorm<Eigen::Infinity>(), v_max);
    EXPECT_LE(at.ddq.lpNorm<Eigen::Infinity>(), a_max * (1.0 + 1e-12));
    jerk = std::max(jerk, (at.ddq - last.ddq).lpNorm<Eigen::Infinity>() / 1e-3);
    last = at;
  }
  std::printf("jerk %.6f of the bound\n", jerk / j_max);
  EXPECT_LE(jerk, j_max * (1.0 + 1e-9));
  EXPECT_GE(jerk, 0.99 * j_max);
}

TEST(PlanTest, StartsAndEndsExactlyAtRest) {
  test::RandomStates random(5);
  const Plan plan = RandomPlan(random, Plan::Capacity(kJoints));
  Reference at;
  for (const double t : {-1.0, 0.0}) {
    plan.At(t, at);
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_EQ(at.q[j], plan.Point(0, j));
    }
    EXPECT_TRUE(at.dq.isZero(0.0) && at.ddq.isZero(0.0));
  }
  for (const double t : {plan.Duration(), plan.Duration() + 7.0, 1e300}) {
    plan.At(t, at);
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_EQ(at.q[j], plan.Point(plan.num_points - 1, j));
    }
    EXPECT_TRUE(at.dq.isZero(0.0) && at.ddq.isZero(0.0));
  }
}

TEST(PlanTest, EveryCapacityFits) {
  for (int joints = 1; joints <= model::kMaxJoints; ++joints) {
    EXPECT_LE(joints * Plan::Capacity(joints), Plan::kMostNumbers);
    EXPECT_GE(Plan::Capacity(joints), 200) << joints;
  }
}

TEST(PlanTest, AnUnsoundPlanIsRefused) {
  test::RandomStates random(6);
  const Plan sound = RandomPlan(random, 20);
  EXPECT_TRUE(sound.IsSound());
  const auto refused = [&sound](auto change) {
    Plan plan = sound;
    change(plan);
    return !plan.IsSound();
  };
  EXPECT_TRUE(refused([](Plan& plan) { plan.num_joints = 0; }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.num_joints = model::kMaxJoints + 1; }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.num_points = 3; }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.num_points = Plan::Capacity(kJoints) + 1; }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.num_points = std::numeric_limits<std::int32_t>::max(); }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.period_s = 0.0; }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.period_s = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.points[20 * kJoints - 1] = std::nan(""); }));
  EXPECT_TRUE(refused([](Plan& plan) { plan.outcome = PlanOutcome::kNoPath; }));
  EXPECT_TRUE(Plan{}.IsSound());
  Plan unknown;
  unknown.outcome = static_cast<PlanOutcome>(kPlanOutcomeWords.size());
  EXPECT_FALSE(unknown.IsSound());
}

TEST(PlanTest, EveryOutcomeHasItsOwnSentence) {
  std::set<std::string> sentences;
  for (const char* words : kPlanOutcomeWords) {
    EXPECT_GT(std::string(words).size(), 10U);
    sentences.insert(words);
  }
  EXPECT_EQ(sentences.size(), kPlanOutcomeWords.size());
  EXPECT_EQ(static_cast<std::size_t>(PlanOutcome::kNotProved) + 1, kPlanOutcomeWords.size());
}

}  // namespace
}  // namespace fovea::trajectory
