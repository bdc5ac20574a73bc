// SPDX-License-Identifier: Apache-2.0
// Faults of the planner beside the tick. SimPlanner applies them (sim/run).
#pragma once

#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct PlannerFaults {
  TimeWindow loss;  // neither requests nor plans are passed on; they wait for its end
};

template <class Visitor, Struct<PlannerFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window(
      {"planner_loss", "s",
       "the planner beside the tick gets no processor: no plan comes, what was asked is answered after it"},
      f.loss, "the client has its own planner");
}

}  // namespace fovea::sim
