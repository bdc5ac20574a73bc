// SPDX-License-Identifier: Apache-2.0
// The proof that a motion is clear, against a dense sampling of it.
#include <gtest/gtest.h>

#include <cstdio>

#include "firmware/planning/motion_proof.hpp"
#include "tests/planning/free_space.hpp"

namespace fovea {
namespace {

using planning::Posture;
using planning::PostureSpace;
using planning::Work;
using trajectory::Plan;
using trajectory::PlanRequest;
using trajectory::Reference;

// The room of hand and links before box 0, beyond the margins of the tick's rows [m].
double RoomBefore(const config::ServoConfig& config, const model::ArmPoses& poses) {
  const barriers::SolidBarriers solid(config);
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, poses);
  const double margin = 2.0 * config.guard.workspace_margin;
  return std::min(solid.ValueOf(1, poses, bodies) - margin,
                  solid.ValueOf(2, poses, bodies) - margin - config.guard.link_clearance);
}

// The smallest along the plan, every 0.2 ms.
double SmallestRoom(const config::ServoConfig& config, const Plan& plan) {
  double least = HUGE_VAL;
  Reference at;
  model::ArmPoses poses;
  const auto steps = static_cast<int>(plan.Duration() / 2e-4);
  for (int i = 0; i <= steps; ++i) {
    plan.At(2e-4 * i, at);
    model::ComputePoses(config.arm, at.q, poses);
    least = std::min(least, RoomBefore(config, poses));
  }
  return least;
}

TEST(MotionProof, FindsEveryBoxOnTheWayAndNoOther) {
  test::RandomStates random(7);
  const model::VecN ready = test::Ready();
  int blocked = 0;
  int clear = 0;
  double nearest_clear = HUGE_VAL;
  double farthest_blocked = -HUGE_VAL;
  std::int64_t most_work = 0;
  for (int k = 0; k < 400; ++k) {
    config::ServoConfig config = test::FreeServo();
    const model::VecN from = ready + 0.4 * random.Joints(config.arm, 1.0);
    const model::VecN to = ready + 0.4 * random.Joints(config.arm, 1.0);
    const Plan plan = test::TimedPlan(config, test::Line(from, to));
    ASSERT_TRUE(plan.IsSound());
    // A box of some millimetres about a place near the hand's way, or the wrist's.
    Reference middle;
    plan.At(random.Uniform(0.2, 0.8) * plan.Duration(), middle);
    model::ArmPoses poses;
    model::ComputePoses(config.arm, middle.q, poses);
    const model::Vec3 place = poses.X_BE.p + random.Vector(0.15);
    const model::Vec3 half(random.Uniform(1e-4, 5e-3), random.Uniform(1e-4, 5e-3),
                           random.Uniform(1e-4, 5e-3));
    config.guard.obstacles.num_boxes = 1;
    config.guard.obstacles.boxes[0] = {place - half, place + half};
    PlanRequest request;
    request.start.q = from;
    request.start.dq.setZero(7);
    request.start.ddq.setZero(7);
    model::ComputePoses(config.arm, ready, poses);
    request.X_BO = poses.X_BE * config.X_EC * model::Pose{model::Mat3::Identity(), {0.0, 0.0, 3.0}};
    PostureSpace space(config);
    hal::Limit limit;
    if (space.Begin(request, limit) != trajectory::PlanOutcome::kFound) {
      continue;
    }
    Posture start;
    Work work(100'000);
    space.Place(from, work, start);
    if (RoomBefore(config, start.poses) < 1e-3) {
      continue;  // such a start has another bound: planner_refusal_test.cpp
    }
    const double first = planning::FirstBlocked(space, plan, work);
    most_work = std::max(most_work, 100'000 - work.left());
    const double room = SmallestRoom(config, plan);
    if (first >= 0.0) {
      ++blocked;
      farthest_blocked = std::max(farthest_blocked, room);
    } else {
      ++clear;
      nearest_clear = std::min(nearest_clear, room);
    }
  }
  std::printf(
      "%d blocked, with %.2f mm of room at most; %d clear, with %.2f mm at least; %lld postures at most\n",
      blocked, 1e3 * farthest_blocked, clear, 1e3 * nearest_clear, static_cast<long long>(most_work));
  EXPECT_GT(blocked, 50);
  EXPECT_GT(clear, 50);
  EXPECT_GE(nearest_clear, 0.0);
  EXPECT_LE(farthest_blocked, 3e-4);  // nearer than this is not proved
}

}  // namespace
}  // namespace fovea
