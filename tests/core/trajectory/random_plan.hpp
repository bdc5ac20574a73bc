// SPDX-License-Identifier: Apache-2.0
// Random plans that are sound.
#pragma once

#include "firmware/core/trajectory/plan.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::trajectory {

// With numbers of any size in its points.
inline Plan RandomPlan(test::RandomStates& random, int joints, int points) {
  Plan plan;
  plan.outcome = PlanOutcome::kFound;
  plan.num_joints = joints;
  plan.num_points = points;
  plan.turn = static_cast<std::int32_t>(random.Uniform(0.0, 4.0));
  plan.stamp_ns = static_cast<std::int64_t>(random.Uniform(1.0, 1e15));
  plan.period_s = random.Uniform(0.001, 0.2);
  for (double& p : plan.p_BO) {
    p = random.Uniform(-1.0, 1.0);
  }
  for (double& q : plan.q_BO) {
    q = random.Uniform(-1.0, 1.0);
  }
  for (int i = 0; i < plan.NumNumbers(); ++i) {
    plan.points[static_cast<std::size_t>(i)] = random.Uniform(-3.0, 3.0);
  }
  return plan;
}

}  // namespace fovea::trajectory
