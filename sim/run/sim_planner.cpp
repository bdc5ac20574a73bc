// SPDX-License-Identifier: Apache-2.0
#include "sim/run/sim_planner.hpp"

namespace fovea::sim {

void SimPlanner::Act(std::int64_t now_ns, bool lockstep) noexcept {
  if (faults_.loss.Contains(now_ns)) {
    return;
  }
  if (box_.requests.Take(request_)) {
    desk_.box().requests.Put(request_);
  }
  if (lockstep) {
    desk_.Act(now_ns);
  }
  if (desk_.box().plans.Take(plan_)) {
    box_.plans.Put(plan_);
  }
}

}  // namespace fovea::sim
