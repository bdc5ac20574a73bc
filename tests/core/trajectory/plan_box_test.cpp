// SPDX-License-Identifier: Apache-2.0
// Hand-over from the planner to the servo: the newest plan wins and is never torn.
#include "firmware/core/trajectory/plan_box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <memory>
#include <thread>

namespace fovea::trajectory {
namespace {

// A plan with the same number in all control points, so that a torn one is detected.
void Make(int number, Plan& plan) {
  plan.stamp_ns = number;
  plan.points.fill(static_cast<double>(number));
}

bool IsWhole(const Plan& plan) {
  const auto expected = static_cast<double>(plan.stamp_ns);
  return std::all_of(plan.points.begin(), plan.points.end(),
                     [expected](double value) { return value == expected; });
}

TEST(PlanMailboxTest, GivesEachPlanOnceAndTheNewestOnly) {
  PlanMailbox mailbox;
  Plan plan;
  Make(7, plan);
  EXPECT_FALSE(mailbox.Take(plan));
  EXPECT_EQ(plan.stamp_ns, 7);  // untouched
  Plan put;
  for (int i = 1; i <= 3; ++i) {
    Make(i, put);
    mailbox.Put(put);
  }
  EXPECT_TRUE(mailbox.Take(plan));
  EXPECT_EQ(plan.stamp_ns, 3);
  EXPECT_TRUE(IsWhole(plan));
  EXPECT_FALSE(mailbox.Take(plan));
}

TEST(PlanMailboxTest, TwoThreadsNeverSeeATornPlan) {
  constexpr int kTaken = 300;
  const auto mailbox = std::make_unique<PlanMailbox>();
  std::atomic<int> taken{0};
  std::atomic<int> put{0};  // set when all were put
  std::thread writer([&] {
    Plan plan;
    int number = 0;
    while (taken < kTaken) {
      Make(++number, plan);
      mailbox->Put(plan);
      std::this_thread::yield();  // the reader's turn, where both share a core
    }
    put = number;
  });
  std::int64_t last = 0;
  bool whole = true;
  bool forward = true;
  Plan plan;
  bool all_put = false;
  while (!all_put) {
    all_put = put != 0;
    if (mailbox->Take(plan)) {
      ++taken;
      whole = whole && IsWhole(plan);
      forward = forward && plan.stamp_ns > last;
      last = plan.stamp_ns;
    }
    std::this_thread::yield();
  }
  writer.join();
  std::printf("%d of %d plans taken\n", taken.load(), put.load());
  EXPECT_TRUE(whole);
  EXPECT_TRUE(forward);
  EXPECT_EQ(last, put);  // the newest is never lost
}

}  // namespace
}  // namespace fovea::trajectory
