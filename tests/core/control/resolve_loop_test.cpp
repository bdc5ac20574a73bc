// SPDX-License-Identifier: Apache-2.0
// Kinematic resolution in closed loop: the benefit of limits inside the solver.
#include <gtest/gtest.h>

#include <iostream>
#include <vector>

#include "tests/core/control/resolve_loop.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::control {
namespace {

TEST(ResolveLoopTest, LimitsInsideTheSolverLetMoreStartsReachTheirGoal) {
  constexpr double kLimitS = 8.0;
  const config::ServoConfig config = test::PandaConfig();
  const NullSpaceConfig wishes = resolve_loop::PostureOnly(config, NullSpaceConfig{}.speed_max);
  const resolve_loop::Resolve ways[3] = {
      resolve_loop::ByFixedDamping, [&](const resolve_loop::Scene& scene) { return ByDamped(scene, wishes); },
      [&](const resolve_loop::Scene& scene) {
        return ByConstrained(scene, wishes, ConstrainedConfig{}, false);
      }};
  test::RandomStates random(541);
  const int starts = test::Repetitions(30);
  int converged[3] = {};
  for (int k = 0; k < starts; ++k) {
    const resolve_loop::Start start = resolve_loop::Sample(random, config);
    for (int way = 0; way < 3; ++way) {
      const resolve_loop::Run run = resolve_loop::Loop(config, start, ways[way], kLimitS);
      converged[way] += run.converged ? 1 : 0;
      EXPECT_LE(run.radius, config.guard.workspace_radius + 1e-3);
      EXPECT_LE(run.range_used, 1.0 + 1e-3);
    }
  }
  std::cout << "of " << starts << " starts converge: " << converged[0] << " by fixed damping, "
            << converged[1] << " damped, " << converged[2] << " constrained\n";
  EXPECT_GE(converged[2], starts * 9 / 10);
  EXPECT_GE(converged[2], converged[0]);
}

}  // namespace
}  // namespace fovea::control
