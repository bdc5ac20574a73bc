// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/planner.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <ostream>
#include <string>

#include "tests/planning/plan_watch.hpp"

namespace fovea {
namespace {

using planning::Planner;
using trajectory::Plan;
using trajectory::PlanOutcome;
using trajectory::PlanRequest;

struct Pair {
  const char* arm;
  const char* target;
};
void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.arm << " " << pair.target; }

class PlannerOn : public testing::TestWithParam<Pair> {};

TEST_P(PlannerOn, EveryPlanKeepsAllLimitsAndReachesTheGoal) {
  constexpr int kStarts = 40;
  const config::ServoConfig config = test::PlannedServo(GetParam().arm, GetParam().target);
  test::PlannedStarts starts(config, 5);
  Planner planner(config);
  Plan plan;
  test::PlanResidual worst;
  int found = 0;
  int narrow = 0;
  for (int i = 0; i < kStarts; ++i) {
    PlanRequest request = starts.Next();
    request.budget = 100'000;
    planner.Compute(request, plan);
    ASSERT_TRUE(plan.IsSound());
    if (!plan.IsFound()) {
      EXPECT_NE(plan.outcome, PlanOutcome::kNotProved) << "start " << i;
      continue;
    }
    ++found;
    test::PlanResidual residual = test::PlanWatch(config, request).Watch(plan);
    EXPECT_LE(residual.held_ticks, 0) << "start " << i;
    if (planner.effort().work > request.budget / 2) {  // nothing was found with all of the room
      ++narrow;
      EXPECT_GE(residual.sight, 0.002) << "start " << i;    // of 0.003
      EXPECT_GE(residual.facing, -0.051) << "start " << i;  // 0.30 of 0.35
      residual.sight = residual.facing = HUGE_VAL;
    }
    worst.Add(residual);
  }
  std::printf(
      "%d of %d, %d of them after half of the budget: velocity %.3f, acceleration %.3f, jerk %.3f of "
      "the limits; room %.1f mm, picture %.1f px, "
      "sight %.1f mm, facing %.4f, corners %.2f deg, tilt %.4f; at the end %.1e; guard held %d ticks, off "
      "%.1e rad\n",
      found, kStarts, narrow, worst.velocity, worst.acceleration, worst.jerk, 1e3 * worst.solid,
      worst.picture_px, 1e3 * worst.sight, worst.facing, worst.corner_deg, worst.tilt, worst.feature,
      worst.held_ticks, worst.guarded);
  EXPECT_GE(found, kStarts / 4);
  EXPECT_LE(worst.start, 1e-12);
  EXPECT_LE(worst.velocity, 1.0);
  EXPECT_LE(worst.acceleration, 1.0);
  EXPECT_LE(worst.jerk, 1.0);
  EXPECT_GE(worst.solid, 0.0);
  EXPECT_GE(worst.picture_px, 13.0);  // of 16.6 at the postures that are tested, or what the start has
  EXPECT_GE(worst.sight, 0.002);      // of 0.01, or of 0.003 if no goal has more
  EXPECT_GE(worst.facing, -0.011);    // 0.01 of it from a start that has less than is needed
  EXPECT_GE(worst.corner_deg, 0.0);   // of 0.26: no start here has less than is needed
  EXPECT_GE(worst.tilt, -1e-3);       // at the start itself it is 0
  EXPECT_LE(worst.feature, 1e-6);
  EXPECT_LE(worst.guarded, 2e-3);  // half a tick's motion
}

INSTANTIATE_TEST_SUITE_P(Arms, PlannerOn,
                         testing::Values(Pair{"panda", "sphere"}, Pair{"panda", "circle"},
                                         Pair{"panda", "square"}, Pair{"panda", "triangle"},
                                         Pair{"ur5e", "sphere"}, Pair{"ur5e", "circle"},
                                         Pair{"ur5e", "square"}, Pair{"ur5e", "triangle"},
                                         Pair{"puma560", "sphere"}, Pair{"puma560", "circle"},
                                         Pair{"puma560", "square"}, Pair{"puma560", "triangle"},
                                         Pair{"gantry", "sphere"}, Pair{"gantry", "triangle"}),
                         [](const testing::TestParamInfo<Pair>& pair) {
                           return std::string(pair.param.arm) + "_" + pair.param.target;
                         });

}  // namespace
}  // namespace fovea
