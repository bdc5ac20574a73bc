// SPDX-License-Identifier: Apache-2.0
// What the planner is asked.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/types.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::trajectory {

struct PlanRequest {
  // A plan leads from rest to rest at the goal. A horizon is what a predictive law does next: it leads from
  // any motion towards the goal, and ends at rest after a fixed time, wherever that is.
  enum class Kind : std::uint8_t { kPlan, kHorizon };

  Kind kind = Kind::kPlan;
  Reference start;                             // from which the arm leaves [num_joints]; at rest for a plan
  model::VecN q_off;                           // [num_joints] measured less start, a horizon allows for it
  model::Pose X_BO;                            // the target's estimate; a ball's orientation does not matter
  model::Vec3 v_BO = model::Vec3::Zero();      // the target's velocity, which a horizon continues [m/s]
  model::Vec3 normal_B = model::Vec3::Zero();  // of a disc, away from a camera that sees it; 0: unknown
  std::int64_t stamp_ns = 0;                   // of the estimate
  std::uint64_t seed = 1;
  // Work that the search may do, counted in postures of the arm (a few microseconds each), not in time: so a
  // request has the same answer on every computer.
  std::int64_t budget = 400'000;
};

// True if the target's feature determines the camera's pose, or all of it except the orientation, and the arm
// can take any pose: then a plan has a defined goal. Real-time: yes.
[[nodiscard]] bool HasGoalPosture(const config::ServoConfig& config) noexcept;

// True if the servo uses plans, too. Real-time: yes.
[[nodiscard]] inline bool IsPlannable(const config::ServoConfig& config) noexcept {
  return config.law.plans && HasGoalPosture(config);
}

// The request of a tick whose record has one more in way.plans_asked than the tick before.
[[nodiscard]] PlanRequest RequestOf(const hal::TickRecord& record) noexcept;

}  // namespace fovea::trajectory
