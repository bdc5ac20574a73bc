// SPDX-License-Identifier: Apache-2.0
// The planner of a simulated run, with its fault: while it acts, the planner is like a thread that gets no
// processor. Requests and plans wait for the fault's end; if it has none, the planner is dead.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/trajectory/plan_box.hpp"
#include "firmware/planning/plan_desk.hpp"
#include "sim/faults/planner_faults.hpp"

namespace fovea::sim {

class SimPlanner {
 public:
  // `config`, `reach`: as for Planner.
  SimPlanner(const config::ServoConfig& config, const planning::EyeReach& reach, const PlannerFaults& faults)
      : desk_(config, reach), faults_(faults) {}

  // For ServoLoop::UsePlanner.
  [[nodiscard]] trajectory::PlanBox& box() noexcept { return box_; }

  // At real pace: the planner has its own thread from now on.
  void Begin() { desk_.Begin(); }
  // Call it between two ticks, on their thread. `lockstep`: plans come at modelled times; else Begin was
  // called.
  void Act(std::int64_t now_ns, bool lockstep) noexcept;
  // Changes the faults from the next Act on. From the same thread.
  void SetFaults(const PlannerFaults& faults) noexcept { faults_ = faults; }

 private:
  planning::PlanDesk desk_;
  PlannerFaults faults_;
  trajectory::PlanBox box_;  // the servo's
  hal::TickRecord request_;
  trajectory::Plan plan_;
};

}  // namespace fovea::sim
