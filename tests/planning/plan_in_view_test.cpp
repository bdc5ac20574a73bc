// SPDX-License-Identifier: Apache-2.0
// Plans keep the target where the eye finds it: at the detector's distances, and away from the picture's
// edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <iterator>

#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "firmware/planning/planner.hpp"
#include "tests/planning/starts.hpp"

namespace fovea {
namespace {

using planning::EyeReach;
using planning::Planner;
using trajectory::Plan;
using trajectory::PlanRequest;

// The least and the largest distance of the target from the camera along a plan [m].
struct Distances {
  double least = HUGE_VAL;
  double most = 0.0;
};

Distances Along(const config::ServoConfig& config, const PlanRequest& request, const Plan& plan) {
  Distances distances;
  trajectory::Reference at;
  model::ArmPoses poses;
  for (double t = 0.0; t <= plan.Duration(); t += 0.01) {
    plan.At(t, at);
    model::ComputePoses(config.arm, at.q, poses);
    const double distance = ((poses.X_BE * config.X_EC).p - request.X_BO.p).norm();
    distances.least = std::min(distances.least, distance);
    distances.most = std::max(distances.most, distance);
  }
  return distances;
}

TEST(PlanInView, KeepsTheDetectorsDistances) {
  constexpr int kStarts = 60;
  const EyeReach reach{0.35, 0.8};
  const config::ServoConfig config = test::PlannedServo("panda", "sphere");
  test::PlannedStarts starts(config, 11);
  Planner free(config);
  Planner kept(config, reach);
  int found = 0;
  int beyond = 0;  // without the limits
  for (int i = 0; i < kStarts; ++i) {
    PlanRequest request = starts.Next();
    request.budget = 100'000;
    Plan plan;
    kept.Compute(request, plan);
    if (plan.IsFound()) {
      ++found;
      const Distances along = Along(config, request, plan);
      model::ArmPoses poses;
      model::ComputePoses(config.arm, request.start.q, poses);
      const double start = ((poses.X_BE * config.X_EC).p - request.X_BO.p).norm();
      // A start out of these limits is not led farther out. Postures are tested every 0.02 rad.
      constexpr double kBetween = 0.01;
      EXPECT_GE(along.least, std::min(reach.nearest, start) - kBetween) << "start " << i;
      EXPECT_LE(along.most, std::max(reach.farthest, start) + kBetween) << "start " << i;
    }
    free.Compute(request, plan);
    if (plan.IsFound()) {
      const Distances along = Along(config, request, plan);
      beyond += along.least < reach.nearest || along.most > reach.farthest ? 1 : 0;
    }
  }
  std::cout << found << " of " << kStarts << " planned within the limits; " << beyond
            << " go beyond without them\n";
  EXPECT_GE(found, kStarts / 3);
  EXPECT_GE(beyond, 5);
}

// Straight to this goal, the target would pass along the picture's edge at a crawl, in 24 s.
TEST(PlanInView, LeadsInwardFromThePicturesEdge) {
  const config::ServoConfig config = test::PlannedServo("panda", "triangle");
  const double q[] = {2.031, -1.476, 1.427, -2.624, 2.839, 3.218, 1.867};
  PlanRequest request;
  request.start.q = Eigen::Map<const Eigen::VectorXd>(q, std::size(q));
  request.start.dq.setZero(std::size(q));
  request.start.ddq.setZero(std::size(q));
  request.X_BO = {config::RollPitchYaw({68.51, -33.48, -101.88}), {-0.5945, 0.4934, 0.2937}};
  Plan plan;
  Planner(config, {0.12, 1.2}).Compute(request, plan);
  ASSERT_TRUE(plan.IsFound());
  std::cout << "takes " << plan.Duration() << " s\n";
  EXPECT_LT(plan.Duration(), 6.0);
}

}  // namespace
}  // namespace fovea
