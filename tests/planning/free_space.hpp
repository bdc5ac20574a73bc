// SPDX-License-Identifier: Apache-2.0
// Motions of the Panda along straight joint paths, where nothing is in the way.
#pragma once

#include <algorithm>

#include "firmware/planning/path_speed.hpp"
#include "firmware/planning/time_path.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::test {

// Without obstacles, picture and limits of the hand.
inline config::ServoConfig FreeServo() {
  config::ServoConfig config = PandaConfig();
  config.guard.workspace_radius = 100.0;
  config.guard.workspace_deceleration = 100.0;
  config.guard.cartesian_speed = 100.0;
  config.guard.rotation_speed = 100.0;
  config.guard.self_clearance = 0.0;
  config.guard.sight_clearance = 0.0;
  return config;
}

// A plan along the polyline, as the planner times it. Its duration is 0 if there is none.
inline trajectory::Plan TimedPlan(const config::ServoConfig& config, const planning::Polyline& corners) {
  const planning::PostureSpace space(config);
  const planning::JointLimits limits = planning::LimitsOfPlan(config);
  const planning::SmoothPath path(corners);
  planning::PathSpeed speed(limits, static_cast<int>(corners.size()));
  planning::Work work(1'000'000);
  speed.Begin(space, path, work);
  trajectory::Plan plan;
  plan.outcome = trajectory::PlanOutcome::kFound;
  plan.num_joints = config.arm.num_joints;
  const double duration = speed.Run();
  if (std::isfinite(duration)) {
    planning::TimePath(path, speed, duration, limits, plan);
  }
  return plan;
}

// Straight from `from` to `to`, with corners about 0.1 rad apart.
inline planning::Polyline Line(const model::VecN& from, const model::VecN& to) {
  const int parts = std::max(static_cast<int>((to - from).norm() / 0.1), 3);
  planning::Polyline line;
  for (int i = 0; i <= parts; ++i) {
    line.push_back(from + static_cast<double>(i) / parts * (to - from));
  }
  line.back() = to;
  return line;
}

}  // namespace fovea::test
