// SPDX-License-Identifier: Apache-2.0
// Plans in pieces: whole or not at all, whatever the line does with the pieces.
#include "firmware/core/trajectory/plan_part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <vector>

#include "tests/core/trajectory/random_plan.hpp"

namespace fovea::trajectory {
namespace {

std::vector<PlanPart> PartsOf(const Plan& plan) {
  std::vector<PlanPart> parts;
  PlanSender sender;
  EXPECT_TRUE(sender.IsDone());
  sender.Begin(plan);
  while (!sender.IsDone() && parts.size() < 1000) {
    parts.push_back(sender.Next());
  }
  EXPECT_FALSE(sender.Next().IsThere());
  return parts;
}

// What was sent, or no motion at all.
void ExpectSame(const Plan& a, const Plan& b) {
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.blocker, b.blocker);
  EXPECT_EQ(a.num_joints, b.num_joints);
  ASSERT_EQ(a.num_points, b.num_points);
  EXPECT_EQ(a.turn, b.turn);
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  EXPECT_EQ(a.period_s, b.period_s);
  EXPECT_EQ(a.p_BO, b.p_BO);
  EXPECT_EQ(a.q_BO, b.q_BO);
  EXPECT_TRUE(std::equal(a.points.begin(), a.points.begin() + a.NumNumbers(), b.points.begin()));
}

TEST(PlanPartTest, EveryPlanArrivesWhole) {
  test::RandomStates random(11);
  PlanReceiver receiver;
  for (int joints = 1; joints <= model::kMaxJoints; ++joints) {
    for (const int points : {Plan::kLeastPoints, 7, 42, Plan::Capacity(joints)}) {
      const Plan plan = RandomPlan(random, joints, points);
      const std::vector<PlanPart> parts = PartsOf(plan);
      EXPECT_EQ(parts.size(), static_cast<std::size_t>((plan.NumNumbers() + 41) / PlanPart::kMostNumbers));
      for (std::size_t i = 0; i < parts.size(); ++i) {
        ASSERT_EQ(receiver.Take(parts[i]), i + 1 == parts.size()) << joints << ", " << points << ", " << i;
      }
      EXPECT_TRUE(receiver.plan().IsSound());
      ExpectSame(receiver.plan(), plan);
    }
  }
}

TEST(PlanPartTest, PlanWithoutAMotionIsOnePart) {
  PlanReceiver receiver;
  for (std::size_t outcome = 1; outcome < kPlanOutcomeWords.size(); ++outcome) {
    Plan plan;
    plan.outcome = static_cast<PlanOutcome>(outcome);
    plan.blocker = hal::Limit::kObstacle;
    plan.stamp_ns = 5;
    const std::vector<PlanPart> parts = PartsOf(plan);
    ASSERT_EQ(parts.size(), 1U);
    EXPECT_TRUE(parts[0].IsThere());
    EXPECT_TRUE(receiver.Take(parts[0]));
    ExpectSame(receiver.plan(), plan);
  }
}

TEST(PlanPartTest, LostPartIsTakenWhenThePlanComesAgain) {
  test::RandomStates random(12);
  PlanReceiver receiver;
  Plan plan = RandomPlan(random, 7, 60);
  for (std::size_t lost = 0; lost < 10; ++lost) {
    plan.stamp_ns = static_cast<std::int64_t>(lost) + 1;
    const std::vector<PlanPart> parts = PartsOf(plan);
    ASSERT_EQ(parts.size(), 10U);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      EXPECT_FALSE(i != lost && receiver.Take(parts[i])) << lost;
    }
    EXPECT_FALSE(receiver.IsWhole() && receiver.plan().stamp_ns == plan.stamp_ns);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      EXPECT_EQ(receiver.Take(parts[i]), i + 1 == parts.size()) << lost << ", " << i;
    }
    EXPECT_TRUE(receiver.IsWhole());
    ExpectSame(receiver.plan(), plan);
  }
}

TEST(PlanPartTest, RepeatedPartsChangeNothing) {
  test::RandomStates random(12);
  PlanReceiver receiver;
  const Plan plan = RandomPlan(random, 7, 60);
  const std::vector<PlanPart> parts = PartsOf(plan);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(receiver.Take(parts[i]), i + 1 == parts.size());
    for (std::size_t earlier = 0; earlier <= i; ++earlier) {
      EXPECT_FALSE(receiver.Take(parts[earlier])) << "repeated";
    }
  }
  EXPECT_TRUE(receiver.IsWhole());
  ExpectSame(receiver.plan(), plan);
}

// The same parts from a line that loses every second one: each round brings what is missing next.
TEST(PlanPartTest, PlanArrivesOverALineThatLosesHalf) {
  test::RandomStates random(17);
  std::mt19937 line(18);
  std::bernoulli_distribution is_lost(0.5);
  const Plan plan = RandomPlan(random, 7, 250);
  const std::vector<PlanPart> parts = PartsOf(plan);
  ASSERT_EQ(parts.size(), 42U);
  PlanReceiver receiver;
  bool is_whole = false;
  int rounds = 0;
  for (; !is_whole && rounds < 1000; ++rounds) {
    for (const PlanPart& part : parts) {
      is_whole = (!is_lost(line) && receiver.Take(part)) || is_whole;
    }
  }
  std::cout << rounds << " rounds of 42 parts\n";
  EXPECT_LE(rounds, 60);
  ExpectSame(receiver.plan(), plan);
}

// Parts of several plans in any order: what is accepted is one of the plans, bit by bit.
TEST(PlanPartTest, OnlyWholePlansAreAcceptedFromAnyMixture) {
  test::RandomStates random(13);
  std::mt19937 shuffle(14);
  int accepted = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<Plan> plans;
    std::vector<PlanPart> line;
    for (int i = 0; i < 3; ++i) {
      plans.push_back(RandomPlan(random, 1 + k % 7, 5 + k % 20));
      plans.back().stamp_ns = i;
      for (const PlanPart& part : PartsOf(plans.back())) {
        line.push_back(part);
      }
    }
    if (k % 3 != 0) {
      std::shuffle(line.begin(), line.end(), shuffle);
    } else {
      line.erase(line.begin() + static_cast<int>(random.Uniform(0.0, static_cast<double>(line.size()))));
    }
    PlanReceiver receiver;
    for (const PlanPart& part : line) {
      if (receiver.Take(part)) {
        ++accepted;
        ASSERT_TRUE(receiver.plan().IsSound());
        ExpectSame(receiver.plan(), plans[static_cast<std::size_t>(receiver.plan().stamp_ns)]);
      }
    }
  }
  EXPECT_GT(accepted, 100);
}

// The head counts as it came with the first part: later parts cannot change it.
TEST(PlanPartTest, LaterPartsCannotChangeTheHead) {
  test::RandomStates random(15);
  const Plan plan = RandomPlan(random, 7, 12);
  std::vector<PlanPart> parts = PartsOf(plan);
  ASSERT_EQ(parts.size(), 2U);
  parts[1].head.num_points = 4;
  parts[1].head.num_joints = 1;
  parts[1].head.turn = 3;
  parts[1].head.period_s = -1.0;
  PlanReceiver receiver;
  EXPECT_FALSE(receiver.Take(parts[0]));
  EXPECT_TRUE(receiver.Take(parts[1]));
  ExpectSame(receiver.plan(), plan);
  parts[1].head.stamp_ns += 1;
  EXPECT_FALSE(receiver.Take(parts[0]));
  EXPECT_FALSE(receiver.Take(parts[1])) << "of another plan";
}

class BadPart : public testing::Test {
 protected:
  // The plan with a changed part does not become whole; then the next plan does.
  template <class Change>
  void ExpectDropped(std::size_t which, const Change& change) {
    Plan plan = RandomPlan(random_, 7, 20);
    plan.stamp_ns = ++stamp_ns_;
    std::vector<PlanPart> parts = PartsOf(plan);
    change(parts[which]);
    for (const PlanPart& part : parts) {
      EXPECT_FALSE(receiver_.Take(part));
    }
    EXPECT_FALSE(receiver_.IsWhole() && receiver_.plan().stamp_ns == plan.stamp_ns);
    Plan next = RandomPlan(random_, 7, 5);
    next.stamp_ns = ++stamp_ns_;
    ASSERT_EQ(PartsOf(next).size(), 1U);
    EXPECT_TRUE(receiver_.Take(PartsOf(next)[0]));
    ExpectSame(receiver_.plan(), next);
  }

  test::RandomStates random_{16};
  std::int64_t stamp_ns_ = 0;  // a stamp names a plan
  PlanReceiver receiver_;
};

TEST_F(BadPart, NumberThatIsNotFiniteDropsThePlan) {
  for (std::size_t which = 0; which < 4; ++which) {
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      const std::size_t place = which == 3 ? 13 : 41;  // the last number
      ExpectDropped(which, [&](PlanPart& part) { part.numbers[place] = bad; });
      ExpectDropped(which, [&](PlanPart& part) { part.numbers[0] = bad; });
    }
  }
  ExpectDropped(0, [](PlanPart& part) { part.head.period_s = std::nan(""); });
  ExpectDropped(0, [](PlanPart& part) { part.head.p_BO[2] = HUGE_VAL; });
  ExpectDropped(0, [](PlanPart& part) { part.head.q_BO[3] = std::nan(""); });
}

TEST_F(BadPart, AbsurdSizeDropsThePlan) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  for (const std::int32_t absurd : {kLeast, -7, -1, 43, 1800, 1801, kMost - 41, kMost}) {
    for (std::size_t which = 0; which < 4; ++which) {
      ExpectDropped(which, [&](PlanPart& part) { part.count = absurd; });
      ExpectDropped(which, [&](PlanPart& part) { part.first = absurd; });
    }
  }
  for (const std::int32_t absurd : {kLeast, -1, 0, 3, 258, kMost / 7, kMost / 7 + 1, kMost}) {
    ExpectDropped(0, [&](PlanPart& part) { part.head.num_points = absurd; });
  }
  for (const std::int32_t absurd : {kLeast, -1, 0, model::kMaxJoints + 1, kMost}) {
    ExpectDropped(0, [&](PlanPart& part) { part.head.num_joints = absurd; });
  }
  ExpectDropped(0, [](PlanPart& part) { part.head.outcome = PlanOutcome::kNoPath; });
  ExpectDropped(0, [](PlanPart& part) {
    part.head.outcome = static_cast<PlanOutcome>(kPlanOutcomeWords.size());
    part.head.num_points = 0;
  });
}

// After a drop, no part continues what was dropped, wherever it says that it begins.
TEST_F(BadPart, NothingContinuesWhatWasDropped) {
  for (std::int32_t first = -100; first < 0; ++first) {
    for (std::int32_t count = -3; count <= 42; ++count) {
      PlanPart bad;
      bad.first = 0;
      bad.count = 43;
      EXPECT_FALSE(receiver_.Take(bad));
      PlanPart next;
      next.first = first;
      next.count = count;
      next.numbers.fill(7.0);
      ASSERT_FALSE(receiver_.Take(next)) << first << ", " << count;
    }
  }
}

}  // namespace
}  // namespace fovea::trajectory
