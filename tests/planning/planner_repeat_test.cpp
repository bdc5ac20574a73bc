// SPDX-License-Identifier: Apache-2.0
// The same request has the same answer, within its budget and without a heap call.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <iostream>
#include <memory>
#include <vector>

#include "firmware/planning/planner.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "tests/planning/starts.hpp"

namespace fovea {
namespace {

using planning::Planner;
using trajectory::Plan;
using trajectory::PlanRequest;

constexpr int kStarts = 25;
// A loop that finds the budget used up ends its step, and a timed motion its check by the guard.
constexpr std::int64_t kBeyond = 3000;

bool AreSame(const Plan& a, const Plan& b) {
  return a.outcome == b.outcome && a.blocker == b.blocker && a.num_points == b.num_points &&
         a.turn == b.turn && std::memcmp(&a.period_s, &b.period_s, sizeof(double)) == 0 &&
         std::memcmp(a.points.data(), b.points.data(), sizeof(a.points)) == 0;
}

TEST(PlannerRepeat, TheAnswerDependsOnTheRequestAlone) {
  const config::ServoConfig config = test::PlannedServo("panda", "square");
  test::PlannedStarts starts(config, 8);
  std::vector<PlanRequest> requests;
  std::vector<Plan> answers(kStarts);
  Planner planner(config);
  for (int i = 0; i < kStarts; ++i) {
    requests.push_back(starts.Next());
    requests.back().budget = 40'000;
    planner.Compute(requests.back(), answers[static_cast<std::size_t>(i)]);
  }
  // Another planner, in the other order.
  Planner other(config);
  int found = 0;
  int changed = 0;
  for (std::size_t i = kStarts; i-- > 0;) {
    Plan plan;
    other.Compute(requests[i], plan);
    EXPECT_TRUE(AreSame(plan, answers[i])) << "start " << i;
    found += plan.IsFound() ? 1 : 0;
    ++requests[i].seed;
    other.Compute(requests[i], plan);
    changed += AreSame(plan, answers[i]) ? 0 : 1;
  }
  std::printf("%d of %d found, %d differ with another seed\n", found, kStarts, changed);
  EXPECT_GT(found, 0);
  EXPECT_GT(changed, 0);
}

TEST(PlannerRepeat, TheWorkStaysWithinTheBudget) {
  const config::ServoConfig config = test::PlannedServo("panda", "triangle");
  test::PlannedStarts starts(config, 9);
  Planner planner(config);
  Plan plan;
  std::int64_t most_beyond = 0;
  for (int i = 0; i < kStarts; ++i) {
    PlanRequest request = starts.Next();
    for (const std::int64_t budget : {-5, 0, 1, 100, 1000, 5000, 20'000, 60'000}) {
      request.budget = budget;
      planner.Compute(request, plan);
      most_beyond = std::max(most_beyond, planner.effort().work - std::max<std::int64_t>(budget, 0));
      EXPECT_TRUE(budget >= 100 || !plan.IsFound());
    }
  }
  std::printf("at most %lld postures beyond the budget\n", static_cast<long long>(most_beyond));
  EXPECT_LE(most_beyond, Planner::kProofWork + kBeyond);
}

TEST(PlannerRepeat, APlannerUsesNoHeapAfterItsConstructor) {
  ASSERT_TRUE(linux_rt::HeapCounterActive());
  const config::ServoConfig config = test::PlannedServo("panda", "square");
  test::PlannedStarts starts(config, 10);
  Planner planner(config);
  Plan plan;
  int found = 0;
  for (int i = 0; i < kStarts; ++i) {
    const PlanRequest request = starts.Next();
    const std::uint64_t before = linux_rt::CountedHeapCalls();
    linux_rt::EnterCountedRegion();
    planner.Compute(request, plan);
    linux_rt::LeaveCountedRegion();
    EXPECT_EQ(linux_rt::CountedHeapCalls(), before) << "start " << i;
    found += plan.IsFound() ? 1 : 0;
  }
  EXPECT_GT(found, 0);
}

TEST(PlannerRepeat, AHorizonUsesNoHeapEither) {
  ASSERT_TRUE(linux_rt::HeapCounterActive());
  int found = 0;
  for (const char* target : {"sphere", "circle", "square", "triangle"}) {
    const config::ServoConfig config = test::PlannedServo("panda", target);
    test::PlannedStarts starts(config, 10);
    Planner planner(config);
    Plan plan;
    for (int i = 0; i < kStarts; ++i) {
      PlanRequest request = starts.Next();
      request.kind = PlanRequest::Kind::kHorizon;
      request.start.dq.setConstant(0.2);
      request.q_off.setConstant(request.start.q.size(), 1e-3);
      const std::uint64_t before = linux_rt::CountedHeapCalls();
      linux_rt::EnterCountedRegion();
      planner.Compute(request, plan);
      linux_rt::LeaveCountedRegion();
      EXPECT_EQ(linux_rt::CountedHeapCalls(), before) << "start " << i;
      EXPECT_TRUE(plan.IsSound());
      found += plan.IsFound() ? 1 : 0;
    }
  }
  std::cout << found << " of " << 4 * kStarts << " random starts have a horizon\n";
  EXPECT_GT(found, 2 * kStarts);
}

}  // namespace
}  // namespace fovea
